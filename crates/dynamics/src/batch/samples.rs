//! The models of a batch: one for all states, or one for each.

use super::Number;
use super::kernels::Workspace;
use super::register::Register;
use super::run::{Inputs, RunsOn, WRENCH};
use crate::error::expect;
use crate::step::expect_bodies;
use crate::{DimensionError, Error};
use featherbench_model::{Axis, Label, Model, Topology};
use featherbench_spatial::{Force, Mat3, Motion, Real, RigidBodyInertia, Sym3, Transform, Vec3};
use std::array::from_fn;
use std::borrow::Cow;

#[derive(Clone, Debug)]
pub(super) enum Models<'m, S: Number> {
    One(Cow<'m, Model<S>>),
    /// One model for each state. There is at least one.
    Each(Samples<'m, S>),
}

#[derive(Clone, Debug)]
pub(super) struct Samples<'m, S: Number> {
    samples: &'m [Model<S>],
    /// The topology of all: an axis is along z where it is in all samples.
    topology: Topology,
    /// The label of a body, if it has the same in all samples, or else [`Label::Z`].
    labels: Vec<Label>,
    /// Whether a body has the same label in all samples. If not, its wrenches are brought into compiled axes lane by lane.
    same_label: Vec<bool>,
}

impl<'m, S: Number> Models<'m, S> {
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
        let same_label: Vec<bool> = (0..bodies).map(|i| samples.iter().all(|sample| sample.labels[i] == first.labels[i])).collect();
        let labels: Vec<Label> = same_label.iter().zip(&first.labels).map(|(same, label)| if *same { *label } else { Label::Z }).collect();
        Ok(Self::Each(Samples { samples, topology, labels, same_label }))
    }

    /// The models in lanes, group by group, if each state has its own.
    pub(super) fn pack<L: Register<S>>(&self) -> Vec<Model<L>> {
        match self {
            Self::One(_) => Vec::new(),
            Self::Each(each) => {
                let in_lanes = |group: &[Model<S>]| each.pack(|lane| &group[lane.min(group.len() - 1)]);
                each.samples.chunks(L::LANES).map(in_lanes).collect()
            }
        }
    }

    pub(super) fn topology(&self) -> &Topology {
        match self {
            Self::One(model) => &model.topology,
            Self::Each(each) => &each.topology,
        }
    }

    /// How many states have a model, if each has its own.
    pub(super) fn count(&self) -> Option<usize> {
        match self {
            Self::One(_) => None,
            Self::Each(each) => Some(each.samples.len()),
        }
    }

    /// The compiled body of each described body.
    pub(super) fn described(&self) -> &[usize] {
        match self {
            Self::One(model) => &model.described,
            Self::Each(each) => &each.samples[0].described,
        }
    }

    /// An error unless the axes of each body have the same names in all samples: what is in described axes can then be computed in lanes.
    pub(super) fn expect_same_labels(&self) -> Result<(), DimensionError> {
        match self {
            Self::One(_) => Ok(()),
            Self::Each(each) => {
                let same = each.same_label.iter().filter(|same| **same).count();
                expect("bodies whose joint axis is the same coordinate axis in all samples, or skew in all", each.same_label.len(), same)
            }
        }
    }

    /// Runs a kernel on a group. External wrenches are kept in `wrenches`.
    #[inline(always)]
    pub(super) fn run<'w, K: RunsOn<S, L, N>, L: Register<S>, const N: usize>(
        &self,
        packed: &[Model<L>],
        group: usize,
        workspace: &'w mut Workspace<L>,
        inputs: Inputs<&[L], N>,
        wrenches: &mut [Force<L>],
    ) -> (&'w [L], Result<(), Error>) {
        let external = inputs.wrenches.map(|numbers| forces(numbers, wrenches));
        match self {
            Self::One(model) => K::run(workspace, model, inputs.vectors, external.as_deref()),
            Self::Each(each) => {
                let last = each.samples.len() - 1;
                let external = external.map(|forces| each.relabel(forces, |lane| (group * L::LANES + lane).min(last)));
                K::run_each(workspace, &packed[group], inputs.vectors, external)
            }
        }
    }

    /// Runs a kernel on copies of one state.
    pub(super) fn run_copies<'w, K: RunsOn<S, L, N>, L: Register<S>, const N: usize>(
        &self,
        state: usize,
        workspace: &'w mut Workspace<L>,
        inputs: Inputs<&[L], N>,
        wrenches: &mut [Force<L>],
    ) -> (&'w [L], Result<(), Error>) {
        let external = inputs.wrenches.map(|numbers| forces(numbers, wrenches));
        match self {
            Self::One(model) => K::run(workspace, model, inputs.vectors, external.as_deref()),
            Self::Each(each) => {
                let external = external.map(|forces| each.relabel(forces, |_| state));
                K::run_each(workspace, &each.pack(|_| &each.samples[state]), inputs.vectors, external)
            }
        }
    }
}

impl<S: Number> Samples<'_, S> {
    /// One model of which each lane is a sample.
    fn pack<'a, L: Register<S>>(&self, sample: impl Fn(usize) -> &'a Model<S>) -> Model<L>
    where
        S: 'a,
    {
        pack(&self.topology, &self.labels, sample)
    }

    /// Brings the wrenches of bodies whose label is not the same in all samples into compiled axes. Lane l is a state of sample `sample(l)`.
    #[inline(always)]
    fn relabel<'f, L: Register<S>>(&self, forces: &'f mut [Force<L>], sample: impl Fn(usize) -> usize) -> &'f [Force<L>] {
        for (i, force) in forces.iter_mut().enumerate().filter(|(i, _)| !self.same_label[*i]) {
            let numbers = force.to_array();
            *force = Force::from_array(together(|lane| {
                let described = Force::from_array(from_fn(|k| numbers[k].lanes()[lane]));
                self.samples[sample(lane)].labels[i].force_to_compiled(described).to_array()
            }));
        }
        forces
    }
}

/// The wrenches of a group, one per body, from their numbers.
#[inline(always)]
fn forces<'f, T: Real>(numbers: &[T], forces: &'f mut [Force<T>]) -> &'f mut [Force<T>] {
    for (force, numbers) in forces.iter_mut().zip(numbers.as_chunks::<WRENCH>().0) {
        *force = Force::from_array(*numbers);
    }
    forces
}

/// One model of which each lane is a model of this topology. It gets these labels.
fn pack<'a, S: Number, L: Register<S>>(topology: &Topology, labels: &[Label], sample: impl Fn(usize) -> &'a Model<S>) -> Model<L> {
    let mut packed = L::lift(sample(0));
    packed.topology = topology.clone();
    packed.labels.copy_from_slice(labels);
    for (i, (x, subspace)) in packed.placements.iter_mut().zip(&mut packed.subspaces).enumerate() {
        *x = Transform {
            rotation: Mat3::from_array(together(|lane| sample(lane).placements[i].rotation.to_array())),
            translation: vec3(|lane| sample(lane).placements[i].translation),
        };
        *subspace = Motion { ang: vec3(|lane| sample(lane).subspaces[i].ang), lin: vec3(|lane| sample(lane).subspaces[i].lin) };
    }
    for (i, inertia) in packed.inertias.iter_mut().enumerate() {
        *inertia = RigidBodyInertia {
            mass: L::pack(|lane| sample(lane).inertias[i].mass),
            first_moment: vec3(|lane| sample(lane).inertias[i].first_moment),
            rotational: Sym3::from_array(together(|lane| sample(lane).inertias[i].rotational.to_array())),
        };
    }
    for (k, armature) in packed.armature.iter_mut().enumerate() {
        *armature = L::pack(|lane| sample(lane).armature[k]);
    }
    packed.gravity = vec3(|lane| sample(lane).gravity);
    packed
}

fn vec3<S: Number, L: Register<S>>(vector: impl Fn(usize) -> Vec3<S>) -> Vec3<L> {
    Vec3::from_array(together(|lane| vector(lane).to_array()))
}

/// Arrays, one per lane, as one array of registers.
fn together<S: Number, L: Register<S>, const N: usize>(array: impl Fn(usize) -> [S; N]) -> [L; N] {
    from_fn(|k| L::pack(|lane| array(lane)[k]))
}
