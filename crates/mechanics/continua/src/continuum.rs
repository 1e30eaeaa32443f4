//! A tree of rigid bodies with its elastic coordinates: the reduced tree, the fine tree, and what leads from one to the other.

use crate::block::Block;
use crate::element::{Piece, Spring, Ties};
use crate::{Defect, Refused};
use featherbench_dynamics::DimensionError;
use featherbench_model::{Axis, Description, JointKind, Model, Placement, Topology};
use featherbench_spatial::{Angle, Lift};
use nalgebra::DMatrix;
use std::collections::HashMap;

/// A robot with rods.
///
/// The reduced coordinates s are those of [`Continuum::topology`]: the robot's joints as they are, and one coordinate per spring, shape
/// function or strain, zero where the rod is straight and unloaded. Integrators and sparse factorizations take that topology as they take
/// any other.
#[derive(Clone, Debug)]
pub struct Continuum {
    model: Model<f64>,
    weightless: Model<f64>,
    topology: Topology,
    blocks: Vec<Block>,
    springs: Vec<ReducedSpring>,
    plates: Vec<Plate>,
    /// Of each body of the assembly: the compiled body that it is part of, and its place there; `None` if it is part of the world.
    pub(crate) places: Vec<Option<(usize, Placement)>>,
    direct: bool,
}

/// A spring and a damper of one reduced dof.
#[derive(Clone, Copy, Debug)]
struct ReducedSpring {
    q: usize,
    v: usize,
    stiffness: f64,
    damping: f64,
}

/// The stiffness matrix of some consecutive reduced dofs, and the damping time.
#[derive(Clone, Debug)]
struct Plate {
    q: usize,
    v: usize,
    stiffness: DMatrix<f64>,
    damping: f64,
}

impl Continuum {
    pub(crate) fn build(description: &Description, springs: &[(Spring, f64)], pieces: Vec<(Piece, f64)>) -> Result<Self, Refused> {
        let malformed = |error: &dyn std::fmt::Display| Refused::new("bodies", Defect::Tree { reason: error.to_string() });
        let canonical = description.canonical().map_err(|error| malformed(&error))?;
        let model: Model<f64> = Model::build(&canonical).map_err(|error| malformed(&error))?;
        let mut weightless = model.clone();
        weightless.gravity = featherbench_spatial::Vec3::zero();

        // Where each body of the assembly is.
        let mut named: HashMap<&str, Option<(usize, Placement)>> = HashMap::with_capacity(description.bodies.len());
        for (body, compiled) in canonical.bodies.iter().zip(&model.described) {
            named.insert(&body.name, Some((*compiled, Placement::default())));
        }
        for frame in &canonical.frames {
            named.entry(&frame.name).or_insert(frame.body.map(|body| (model.described[body], frame.placement)));
        }
        let places: Vec<_> = description.bodies.iter().map(|body| named.get(body.name.as_str()).copied().flatten()).collect();
        let compiled = |body: usize| places[body].map(|(compiled, _)| compiled);

        // The piece of each compiled body, and the place of the body in it.
        let joints = model.topology.joints();
        let mut member: Vec<Option<(usize, usize)>> = vec![None; joints.len()];
        for (index, (piece, _)) in pieces.iter().enumerate() {
            for (k, body) in piece.bodies.iter().enumerate() {
                if let Some(compiled) = compiled(*body) {
                    member[compiled] = Some((index, k));
                }
            }
        }

        // The reduced tree: the joints of no piece, and one slide per coordinate of a piece.
        let mut tree: Vec<(Option<usize>, JointKind)> = Vec::new();
        let mut reduced_of: Vec<usize> = Vec::with_capacity(joints.len());
        let mut first_of_piece: Vec<Option<usize>> = vec![None; pieces.len()];
        for (body, joint) in joints.iter().enumerate() {
            let parent = joint.parent.map(|parent| reduced_of[parent]);
            match member[body] {
                None => tree.push((parent, joint.kind)),
                Some((index, _)) if first_of_piece[index].is_none() => {
                    let first = tree.len();
                    first_of_piece[index] = Some(first);
                    for k in 0..pieces[index].0.stiffness.nrows() {
                        tree.push((if k == 0 { parent } else { Some(first + k - 1) }, JointKind::Prismatic(Axis::Skew)));
                    }
                }
                Some(_) => {}
            }
            reduced_of.push(match member[body].and_then(|(index, _)| Some((first_of_piece[index]?, index))) {
                None => tree.len() - 1,
                Some((first, index)) => first + pieces[index].0.stiffness.nrows() - 1,
            });
        }
        let topology = Topology::new(&tree).ok_or_else(|| malformed(&"the reduced tree is not in depth-first order"))?;
        let reduced = topology.joints();

        // The blocks; neighbouring direct joints are one.
        let mut blocks: Vec<Block> = Vec::new();
        for (body, joint) in joints.iter().enumerate().filter(|(body, _)| member[*body].is_none()) {
            let own = &reduced[reduced_of[body]];
            let (q, v) = (joint.q..joint.q + joint.kind.nq(), joint.v..joint.v + joint.kind.nv());
            if let Some(Block::Direct { fine: (in_q, in_v), reduced: (first_q, first_v) }) = blocks.last_mut()
                && (in_q.end, *first_q + in_q.len(), *first_v + in_v.len()) == (q.start, own.q, own.v)
            {
                (in_q.end, in_v.end) = (q.end, v.end);
                continue;
            }
            blocks.push(Block::Direct { fine: (q, v), reduced: (own.q, own.v) });
        }
        let mut plates = Vec::with_capacity(pieces.len());
        let direct = pieces.is_empty();
        for (index, (piece, damping)) in pieces.into_iter().enumerate() {
            let Some(first) = first_of_piece[index] else { continue };
            let (q, v) = (reduced[first].q, reduced[first].v);
            let fine = piece.bodies.iter().filter_map(|body| compiled(*body)).map(|body| (joints[body].q, joints[body].v));
            blocks.push(match piece.ties {
                Ties::Linear { shapes } => Block::Linear { fine: fine.collect(), reduced: (q, v), shapes },
                Ties::Screw { steps, strains } => {
                    let fine = fine.zip(steps).map(|((q, v), step)| (q, v, step)).collect();
                    Block::Screw { fine, reduced: (q, v), strains }
                }
            });
            plates.push(Plate { q, v, stiffness: piece.stiffness, damping });
        }
        let springs = springs.iter().filter_map(|(spring, time)| {
            let own = &reduced[reduced_of[compiled(spring.body)?]];
            Some(ReducedSpring { q: own.q, v: own.v, stiffness: spring.stiffness, damping: spring.stiffness * time })
        });
        let springs = springs.collect();
        Ok(Self { model, weightless, topology, blocks, springs, plates, places, direct })
    }

    /// The reduced tree: what integrators, tree-sparse matrices and this crate's states are sized by.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// The fine tree of rigid bodies. If [`Continuum::is_direct`], its coordinates are the reduced ones.
    pub fn model(&self) -> &Model<f64> {
        &self.model
    }

    /// The fine tree without gravity.
    pub(crate) fn weightless(&self) -> &Model<f64> {
        &self.weightless
    }

    pub(crate) fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// Whether the reduced coordinates are those of the fine tree: rigid links and strings only. Forward dynamics is then O(n), by ABA.
    pub fn is_direct(&self) -> bool {
        self.direct
    }

    /// The reduced configuration in which every rod is straight and the robot at its neutral configuration.
    pub fn rest(&self) -> Vec<f64> {
        featherbench_model::neutral(&self.topology)
    }

    /// The elastic dofs, increasing.
    pub fn elastic_dofs(&self) -> Vec<usize> {
        let of_plates = self.plates.iter().flat_map(|plate| plate.v..plate.v + plate.stiffness.nrows());
        let mut dofs: Vec<usize> = self.springs.iter().map(|spring| spring.v).chain(of_plates).collect();
        dofs.sort_unstable();
        dofs
    }

    /// The same robot with every stiffness times this factor, and the damping with it.
    pub fn stiffened(&self, factor: f64) -> Self {
        let mut result = self.clone();
        for spring in &mut result.springs {
            (spring.stiffness, spring.damping) = (spring.stiffness * factor, spring.damping * factor);
        }
        result.plates.iter_mut().for_each(|plate| plate.stiffness *= factor);
        result
    }

    /// The same robot with gravity times this factor.
    pub fn with_gravity_times(&self, factor: f64) -> Self {
        let mut result = self.clone();
        result.model.gravity = result.model.gravity * factor;
        result
    }

    /// Adds K x + D ẋ to `tau`: what springs and dampers resist with.
    pub(crate) fn add_resistance<T: Angle>(&self, s: &[T], rate: &[T], tau: &mut [T])
    where
        f64: Lift<T>,
    {
        for spring in &self.springs {
            let (k, d): (T, T) = (spring.stiffness.lift(), spring.damping.lift());
            tau[spring.v] += s[spring.q].mul_add(k, rate[spring.v] * d);
        }
        for Plate { q, v, stiffness, damping } in &self.plates {
            let time: T = damping.lift();
            for i in 0..stiffness.nrows() {
                let mut sum = T::zero();
                for j in 0..stiffness.nrows() {
                    sum = rate[v + j].mul_add(time, s[q + j]).mul_add(stiffness[(i, j)].lift(), sum);
                }
                tau[v + i] += sum;
            }
        }
    }

    /// The elastic energy ½ xᵀ K x.
    ///
    /// # Errors
    /// [`DimensionError`] when `s` does not fit.
    pub fn elastic_energy(&self, s: &[f64]) -> Result<f64, DimensionError> {
        DimensionError::expect("configuration s", self.topology.nq(), s.len())?;
        let of_springs = self.springs.iter().map(|spring| 0.5 * spring.stiffness * s[spring.q] * s[spring.q]);
        let of_plates = self.plates.iter().map(|Plate { q, stiffness, .. }| {
            let x = nalgebra::DVectorView::from_slice(&s[*q..], stiffness.nrows());
            0.5 * x.dot(&(stiffness * x))
        });
        Ok(of_springs.sum::<f64>() + of_plates.sum::<f64>())
    }

    /// The stiffness matrix K, dense, nv × nv; zero at the robot's own joints.
    pub fn stiffness_matrix(&self) -> DMatrix<f64> {
        self.dense(|spring| spring.stiffness, |_| 1.0)
    }

    /// The damping matrix D, dense, nv × nv.
    pub fn damping_matrix(&self) -> DMatrix<f64> {
        self.dense(|spring| spring.damping, |plate| plate.damping)
    }

    fn dense(&self, of_spring: impl Fn(&ReducedSpring) -> f64, times: impl Fn(&Plate) -> f64) -> DMatrix<f64> {
        let nv = self.topology.nv();
        let mut matrix = DMatrix::zeros(nv, nv);
        self.springs.iter().for_each(|spring| matrix[(spring.v, spring.v)] += of_spring(spring));
        for plate in &self.plates {
            let size = plate.stiffness.nrows();
            let mut part = matrix.view_mut((plate.v, plate.v), (size, size));
            part += &plate.stiffness * times(plate);
        }
        matrix
    }

    /// Where a body of the assembly is compiled to: the compiled body, and the place of the body's frame on it.
    ///
    /// # Errors
    /// [`Refused`]: there is no such body, or it is part of the world, where no load moves anything.
    pub(crate) fn compiled(&self, body: usize) -> Result<(usize, Placement), Refused> {
        let bodies = self.places.len();
        self.places.get(body).copied().flatten().ok_or_else(|| Refused::new("body", Defect::ClampedToNothing { body, bodies }))
    }
}
