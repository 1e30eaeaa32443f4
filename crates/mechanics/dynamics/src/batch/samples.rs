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
use std::fmt::Debug;

/// The models of the states of a batch: one for all, or one for each. It is a type, so that a program compiles the kernels of those it has.
pub trait Sharing: Clone + Debug {
    /// The models, with parameters in `S`.
    type Models<'m, S: Number>: Models<S>;
}

/// One model for all states.
#[derive(Clone, Copy, Debug)]
pub struct Shared;

/// One model for each state.
#[derive(Clone, Copy, Debug)]
pub struct Sampled;

impl Sharing for Shared {
    type Models<'m, S: Number> = One<'m, S>;
}

impl Sharing for Sampled {
    type Models<'m, S: Number> = Samples<'m, S>;
}

/// What a batch asks of its models.
pub trait Models<S: Number>: Clone + Debug + Sync {
    /// The models in lanes, group by group, if each state has its own.
    fn pack<L: Register<S>>(&self) -> Vec<Model<L>>;

    /// The topology of all.
    fn topology(&self) -> &Topology;

    /// How many states have a model, if each has its own.
    fn count(&self) -> Option<usize>;

    /// The compiled body of each described body.
    fn described(&self) -> &[usize];

    /// An error unless the axes of each body have the same names in all samples: what is in described axes can then be computed in lanes.
    fn expect_same_labels(&self) -> Result<(), DimensionError>;

    /// Runs a kernel on a group. External wrenches are kept in `wrenches`.
    fn run<'w, K: RunsOn<S, L, N>, L: Register<S>, const N: usize>(
        &self,
        packed: &[Model<L>],
        group: usize,
        workspace: &'w mut Workspace<L>,
        inputs: Inputs<&[L], N>,
        wrenches: &mut [Force<L>],
    ) -> (&'w [L], Result<(), Error>);

    /// Runs a kernel on copies of one state.
    fn run_copies<'w, K: RunsOn<S, L, N>, L: Register<S>, const N: usize>(
        &self,
        state: usize,
        workspace: &'w mut Workspace<L>,
        inputs: Inputs<&[L], N>,
        wrenches: &mut [Force<L>],
    ) -> (&'w [L], Result<(), Error>);
}

/// The model of all states.
#[derive(Clone, Debug)]
pub struct One<'m, S: Number>(pub(super) Cow<'m, Model<S>>);

impl<S: Number> Models<S> for One<'_, S> {
    fn pack<L: Register<S>>(&self) -> Vec<Model<L>> {
        Vec::new()
    }

    fn topology(&self) -> &Topology {
        &self.0.topology
    }

    fn count(&self) -> Option<usize> {
        None
    }

    fn described(&self) -> &[usize] {
        &self.0.described
    }

    fn expect_same_labels(&self) -> Result<(), DimensionError> {
        Ok(())
    }

    #[inline(always)]
    fn run<'w, K: RunsOn<S, L, N>, L: Register<S>, const N: usize>(
        &self,
        _packed: &[Model<L>],
        group: usize,
        workspace: &'w mut Workspace<L>,
        inputs: Inputs<&[L], N>,
        wrenches: &mut [Force<L>],
    ) -> (&'w [L], Result<(), Error>) {
        self.run_copies::<K, L, N>(group, workspace, inputs, wrenches)
    }

    #[inline(always)]
    fn run_copies<'w, K: RunsOn<S, L, N>, L: Register<S>, const N: usize>(
        &self,
        _state: usize,
        workspace: &'w mut Workspace<L>,
        inputs: Inputs<&[L], N>,
        wrenches: &mut [Force<L>],
    ) -> (&'w [L], Result<(), Error>) {
        let external = inputs.wrenches.map(|numbers| forces(numbers, wrenches));
        K::run(workspace, &self.0, inputs.vectors, external.as_deref())
    }
}

/// One model for each state. There is at least one.
#[derive(Clone, Debug)]
pub struct Samples<'m, S: Number> {
    samples: &'m [Model<S>],
    /// The topology of all: an axis is along z where it is in all samples.
    topology: Topology,
    /// The label of a body, if it has the same in all samples, or else [`Label::Z`].
    labels: Vec<Label>,
    /// Whether a body has the same label in all samples. If not, its wrenches are brought into compiled axes lane by lane.
    same_label: Vec<bool>,
}

impl<'m, S: Number> Samples<'m, S> {
    /// One model for each state. An axis is along z in all samples, or is taken as a skew one in all.
    pub(super) fn new(samples: &'m [Model<S>]) -> Result<Self, DimensionError> {
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
        Ok(Self { samples, topology, labels, same_label })
    }

    /// One model of which each lane is a sample.
    fn together<L: Register<S>>(&self, lanes: &[&Model<S>]) -> Model<L> {
        pack(&self.topology, &self.labels, lanes)
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

impl<S: Number> Models<S> for Samples<'_, S> {
    fn pack<L: Register<S>>(&self) -> Vec<Model<L>> {
        let in_lanes = |group: &'_ [Model<S>]| {
            let lanes: Vec<&Model<S>> = (0..L::LANES).map(|lane| &group[lane.min(group.len() - 1)]).collect();
            self.together(&lanes)
        };
        self.samples.chunks(L::LANES).map(in_lanes).collect()
    }

    fn topology(&self) -> &Topology {
        &self.topology
    }

    fn count(&self) -> Option<usize> {
        Some(self.samples.len())
    }

    fn described(&self) -> &[usize] {
        &self.samples[0].described
    }

    fn expect_same_labels(&self) -> Result<(), DimensionError> {
        let same = self.same_label.iter().filter(|same| **same).count();
        expect("bodies whose joint axis is the same coordinate axis in all samples, or skew in all", self.same_label.len(), same)
    }

    #[inline(always)]
    fn run<'w, K: RunsOn<S, L, N>, L: Register<S>, const N: usize>(
        &self,
        packed: &[Model<L>],
        group: usize,
        workspace: &'w mut Workspace<L>,
        inputs: Inputs<&[L], N>,
        wrenches: &mut [Force<L>],
    ) -> (&'w [L], Result<(), Error>) {
        let last = self.samples.len() - 1;
        let external = inputs.wrenches.map(|numbers| forces(numbers, wrenches));
        let external = external.map(|forces| self.relabel(forces, |lane| (group * L::LANES + lane).min(last)));
        K::run_each(workspace, &packed[group], inputs.vectors, external)
    }

    #[inline(always)]
    fn run_copies<'w, K: RunsOn<S, L, N>, L: Register<S>, const N: usize>(
        &self,
        state: usize,
        workspace: &'w mut Workspace<L>,
        inputs: Inputs<&[L], N>,
        wrenches: &mut [Force<L>],
    ) -> (&'w [L], Result<(), Error>) {
        let external = inputs.wrenches.map(|numbers| forces(numbers, wrenches));
        let external = external.map(|forces| self.relabel(forces, |_| state));
        K::run_each(workspace, &self.together(&vec![&self.samples[state]; L::LANES]), inputs.vectors, external)
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
fn pack<S: Number, L: Register<S>>(topology: &Topology, labels: &[Label], lanes: &[&Model<S>]) -> Model<L> {
    let mut packed = L::lift(lanes[0]);
    packed.topology = topology.clone();
    packed.labels.copy_from_slice(labels);
    for (i, (x, subspace)) in packed.placements.iter_mut().zip(&mut packed.subspaces).enumerate() {
        *x = Transform {
            rotation: Mat3::from_array(together(|lane| lanes[lane].placements[i].rotation.to_array())),
            translation: vec3(|lane| lanes[lane].placements[i].translation),
        };
        *subspace = Motion { ang: vec3(|lane| lanes[lane].subspaces[i].ang), lin: vec3(|lane| lanes[lane].subspaces[i].lin) };
    }
    for (i, inertia) in packed.inertias.iter_mut().enumerate() {
        *inertia = RigidBodyInertia {
            mass: L::pack(|lane| lanes[lane].inertias[i].mass),
            first_moment: vec3(|lane| lanes[lane].inertias[i].first_moment),
            rotational: Sym3::from_array(together(|lane| lanes[lane].inertias[i].rotational.to_array())),
        };
    }
    for (k, armature) in packed.armature.iter_mut().enumerate() {
        *armature = L::pack(|lane| lanes[lane].armature[k]);
    }
    packed.gravity = vec3(|lane| lanes[lane].gravity);
    packed
}

fn vec3<S: Number, L: Register<S>>(vector: impl Fn(usize) -> Vec3<S>) -> Vec3<L> {
    Vec3::from_array(together(|lane| vector(lane).to_array()))
}

/// Arrays, one per lane, as one array of registers.
fn together<S: Number, L: Register<S>, const N: usize>(array: impl Fn(usize) -> [S; N]) -> [L; N] {
    from_fn(|k| L::pack(|lane| array(lane)[k]))
}
