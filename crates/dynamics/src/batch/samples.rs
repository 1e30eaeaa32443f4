//! The models of a batch: one for all states, or one for each.

use super::Number;
use super::kernels::{Kernel, Workspace};
use crate::error::expect;
use crate::step::expect_bodies;
use crate::{DimensionError, Error};
use featherbench_model::{Axis, Model, Topology};
use featherbench_spatial::{Lift, Mat3, Motion, RigidBodyInertia, Sym3, Transform, Vec3};
use std::array::from_fn;

#[derive(Clone, Debug)]
pub(super) enum Models<'m, S: Number> {
    One(&'m Model<S>),
    /// One model for each state, and the same in lanes, group by group. There is at least one.
    Each(&'m [Model<S>], Vec<Model<S::Lanes>>),
}

impl<'m, S: Number + Lift<S::Lanes>> Models<'m, S> {
    /// One model for each state. An axis is along z in all samples, or is taken as a skew one in all.
    pub(super) fn of_samples(samples: &'m [Model<S>]) -> Result<Self, DimensionError> {
        let Some(first) = samples.first() else {
            return Err(DimensionError { what: "samples of the model", expected: 1, found: 0 });
        };
        let bodies = first.topology.bodies();
        for sample in samples {
            expect_bodies(sample, bodies)?;
            let joints = sample.topology.joints().iter().zip(first.topology.joints());
            let same = joints.filter(|(a, b)| a.parent == b.parent && a.kind.with_axis(Axis::Skew) == b.kind.with_axis(Axis::Skew));
            expect("joints of a sample that are as in the first sample", bodies, same.count())?;
        }
        let kind = |i: usize, sample: &Model<S>| sample.topology.joints()[i].kind;
        let topology = first.topology.with_skew_axes(|i| samples.iter().any(|sample| kind(i, sample) != kind(i, first)));
        let packed = samples.chunks(S::LANES).map(|group| pack(&topology, |lane| &group[lane.min(group.len() - 1)])).collect();
        Ok(Self::Each(samples, packed))
    }

    pub(super) fn topology(&self) -> &Topology {
        match self {
            Self::One(model) => &model.topology,
            Self::Each(_, packed) => &packed[0].topology,
        }
    }

    /// How many states have a model, if each has its own.
    pub(super) fn count(&self) -> Option<usize> {
        match self {
            Self::One(_) => None,
            Self::Each(samples, _) => Some(samples.len()),
        }
    }

    /// Runs a kernel on a group.
    #[inline(always)]
    pub(super) fn run<'w, K: Kernel<N>, const N: usize>(
        &self,
        group: usize,
        workspace: &'w mut Workspace<S::Lanes>,
        inputs: [&[S::Lanes]; N],
    ) -> (&'w [S::Lanes], Result<(), Error>) {
        match self {
            Self::One(model) => K::run(workspace, model, inputs),
            Self::Each(_, packed) => K::run(workspace, &packed[group], inputs),
        }
    }

    /// Runs a kernel on copies of one state.
    pub(super) fn run_copies<'w, K: Kernel<N>, const N: usize>(
        &self,
        state: usize,
        workspace: &'w mut Workspace<S::Lanes>,
        inputs: [&[S::Lanes]; N],
    ) -> (&'w [S::Lanes], Result<(), Error>) {
        match self {
            Self::One(model) => K::run(workspace, model, inputs),
            Self::Each(samples, packed) => K::run(workspace, &pack(&packed[0].topology, |_| &samples[state]), inputs),
        }
    }
}

/// One model of which each lane is a model of this topology.
fn pack<'a, S: Number + Lift<S::Lanes>>(topology: &Topology, sample: impl Fn(usize) -> &'a Model<S>) -> Model<S::Lanes> {
    let mut packed: Model<S::Lanes> = sample(0).lift();
    packed.topology = topology.clone();
    for (i, (x, subspace)) in packed.placements.iter_mut().zip(&mut packed.subspaces).enumerate() {
        *x = Transform {
            rotation: Mat3::from_array(together(|lane| sample(lane).placements[i].rotation.to_array())),
            translation: vec3(|lane| sample(lane).placements[i].translation),
        };
        *subspace = Motion { ang: vec3(|lane| sample(lane).subspaces[i].ang), lin: vec3(|lane| sample(lane).subspaces[i].lin) };
    }
    for (i, inertia) in packed.inertias.iter_mut().enumerate() {
        *inertia = RigidBodyInertia {
            mass: S::pack(|lane| sample(lane).inertias[i].mass),
            first_moment: vec3(|lane| sample(lane).inertias[i].first_moment),
            rotational: Sym3::from_array(together(|lane| sample(lane).inertias[i].rotational.to_array())),
        };
    }
    for (k, armature) in packed.armature.iter_mut().enumerate() {
        *armature = S::pack(|lane| sample(lane).armature[k]);
    }
    packed.gravity = vec3(|lane| sample(lane).gravity);
    packed
}

fn vec3<S: Number>(vector: impl Fn(usize) -> Vec3<S>) -> Vec3<S::Lanes> {
    Vec3::from_array(together(|lane| vector(lane).to_array()))
}

/// Arrays, one per lane, as one array of registers.
fn together<S: Number, const N: usize>(array: impl Fn(usize) -> [S; N]) -> [S::Lanes; N] {
    from_fn(|k| S::pack(|lane| array(lane)[k]))
}
