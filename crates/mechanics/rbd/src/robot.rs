//! A robot: what a file or description says, compiled once, with its joints and frames by name.

use crate::{Error, Workspace};
use featherbench_dynamics::{Batch, PackedModel};
use featherbench_formats::{mjcf, neutral};
use featherbench_model::{Description, JointType, Model};
use featherbench_spatial::Transform;
use std::ops::Range;
use std::sync::Arc;

/// A robot with its compiled model. A clone shares it.
///
/// Coordinates are neutral ([the conventions](crate#conventions)). What ties bodies beside the tree (a URDF's `mimic`, loops) is kept in
/// [`Robot::description`], and no quantity knows of it. Damping and dry friction enter no quantity; armature enters all.
///
/// The functions here allocate their result and a workspace. In a loop, make a [`Workspace`] once ([`Robot::workspace`]), or compute many
/// states at once ([`Robot::batch`]).
///
/// ```
/// use featherbench_rbd::Robot;
///
/// let robot = Robot::generated("humanoid")?;
/// let (q, v) = (robot.neutral(), vec![0.0; robot.nv()]);
/// let tau = robot.inverse_dynamics(&q, &v, &v)?;
/// let a = robot.forward_dynamics(&q, &v, &tau)?;
/// assert!(a.iter().all(|a| a.abs() < 1e-10), "the forces that hold it still leave it at rest");
/// # Ok::<(), featherbench_rbd::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Robot {
    pub(crate) inner: Arc<Inner>,
}

/// What clones share.
#[derive(Debug)]
pub(crate) struct Inner {
    description: Description,
    pub(crate) model: Model<f64>,
    pub(crate) packed: PackedModel,
    pub(crate) joints: Vec<Joint>,
    frames: Vec<Frame>,
    /// Where quaternions begin in q, and the place of their joint in `joints`.
    pub(crate) quaternions: Vec<(usize, usize)>,
    notes: Vec<String>,
    /// Why Pinocchio's own parser gives the same file other coordinates.
    pub(crate) otherwise: Option<String>,
}

/// A joint: its kind, and its numbers in q and v.
///
/// ```
/// let robot = featherbench_rbd::Robot::generated("humanoid")?;
/// let base = &robot.joints()[0];
/// assert_eq!((base.q.clone(), base.v.clone(), base.kind.name()), (0..7, 0..6, "free"));
/// # Ok::<(), featherbench_rbd::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// The joint's name.
    pub name: String,
    /// The kind of motion, with its axis in the joint's frame.
    pub kind: JointType,
    /// Its numbers in q.
    pub q: Range<usize>,
    /// Its numbers in v, a and τ.
    pub v: Range<usize>,
    /// The body that it moves.
    pub body: String,
    /// The body that carries it, or `None` for the world.
    pub parent: Option<String>,
    /// Its frame in the carrying body's frame.
    pub placement: Transform<f64>,
    /// Position limits of each dof, rad or m; infinite where there is none, and empty for spherical and free joints.
    pub limits: Vec<(f64, f64)>,
}

/// A frame: that of a body, or one that is fixed to a body or to the world.
///
/// ```
/// let robot = featherbench_rbd::Robot::generated("chain:n=3")?;
/// let tip = robot.frame(&robot.bodies()[2])?;
/// assert_eq!(tip.name(), robot.bodies()[2]);
/// # Ok::<(), featherbench_rbd::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    pub(crate) name: String,
    /// The compiled body, or `None` for the world.
    pub(crate) body: Option<usize>,
    /// Its placement on that body, if it is not the body's own frame.
    pub(crate) offset: Option<Transform<f64>>,
}

impl Frame {
    /// The frame's name.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let body = robot.bodies()[0];
    /// assert_eq!(robot.frame(body)?.name(), body);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn name(&self) -> &str {
        &self.name
    }
}

impl Robot {
    /// The robot of a description, with what its reader left out.
    pub(crate) fn noted(description: &Description, notes: &[impl ToString]) -> Result<Self, Error> {
        Self::read(description, notes, |_| None)
    }

    /// The same of a file; `otherwise` says why Pinocchio's own parser gives its joints other coordinates.
    pub(crate) fn read(
        description: &Description,
        notes: &[impl ToString],
        otherwise: impl FnOnce(&[Joint]) -> Option<String>,
    ) -> Result<Self, Error> {
        let model = Model::build(description)?;
        let description = description.canonical()?;
        let (mut q, mut v) = (0, 0);
        let mut joints = Vec::with_capacity(description.bodies.len());
        let mut quaternions = Vec::new();
        for body in &description.bodies {
            let joint = &body.joint;
            let (nq, nv) = (joint.kind.nq(), joint.kind.nv());
            match joint.kind {
                JointType::Spherical => quaternions.push((q, joints.len())),
                JointType::Free => quaternions.push((q + 3, joints.len())),
                _ => {}
            }
            joints.push(Joint {
                name: joint.name.clone(),
                kind: joint.kind,
                q: q..q + nq,
                v: v..v + nv,
                body: body.name.clone(),
                parent: body.parent.map(|parent| description.bodies[parent].name.clone()),
                placement: joint.placement.to_transform(),
                limits: if nq == nv { model.limits[q..q + nq].to_vec() } else { Vec::new() },
            });
            (q, v) = (q + nq, v + nv);
        }
        let of_body = |(body, &compiled): (usize, &usize)| Frame { name: joints[body].body.clone(), body: Some(compiled), offset: None };
        let mut frames: Vec<Frame> = model.described.iter().enumerate().map(of_body).collect();
        frames.extend(description.frames.iter().map(|frame| Frame {
            name: frame.name.clone(),
            body: frame.body.map(|body| model.described[body]),
            offset: Some(frame.placement.to_transform()),
        }));
        let packed = PackedModel::new(&model);
        let warnings = model.warnings.iter().map(ToString::to_string);
        let notes = notes.iter().map(ToString::to_string).chain(warnings).collect();
        let otherwise = otherwise(&joints);
        Ok(Self { inner: Arc::new(Inner { description, model, packed, joints, frames, quaternions, notes, otherwise }) })
    }

    /// The robot's name.
    ///
    /// ```
    /// assert!(!featherbench_rbd::Robot::generated("humanoid")?.name().is_empty());
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn name(&self) -> &str {
        &self.inner.description.name
    }

    /// Length of a configuration q.
    ///
    /// ```
    /// assert_eq!(featherbench_rbd::Robot::generated("chain:n=4,base=free")?.nq(), 4 + 7);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn nq(&self) -> usize {
        self.inner.model.topology.nq()
    }

    /// Degrees of freedom: length of v, a and τ.
    ///
    /// ```
    /// assert_eq!(featherbench_rbd::Robot::generated("chain:n=4,base=free")?.nv(), 4 + 6);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn nv(&self) -> usize {
        self.inner.model.topology.nv()
    }

    /// The joints, in the order of their numbers in q and v.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("quadruped")?;
    /// assert_eq!(robot.joints().iter().map(|joint| joint.v.len()).sum::<usize>(), robot.nv());
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn joints(&self) -> &[Joint] {
        &self.inner.joints
    }

    /// The joint of a name: the first, if several have it.
    ///
    /// # Errors
    /// [`Error::NoSuchJoint`], naming those that there are.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let name = robot.joints()[1].name.clone();
    /// assert_eq!(robot.joint(&name)?.q, 1..2);
    /// assert!(robot.joint("elbow").unwrap_err().to_string().contains(&name));
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn joint(&self, name: &str) -> Result<&Joint, Error> {
        let joints = self.joints();
        let known = || listed(joints.iter().map(|joint| joint.name.as_str()));
        joints.iter().find(|joint| joint.name == name).ok_or_else(|| Error::NoSuchJoint { name: name.to_owned(), known: known() })
    }

    /// The names of the bodies that move, each after its parent.
    ///
    /// ```
    /// assert_eq!(featherbench_rbd::Robot::generated("chain:n=5")?.bodies().len(), 5);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn bodies(&self) -> Vec<&str> {
        self.joints().iter().map(|joint| joint.body.as_str()).collect()
    }

    /// The frame of a body, or a frame that is fixed to one: a merged link of a URDF, for example.
    ///
    /// # Errors
    /// [`Error::NoSuchFrame`], naming those that there are.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// assert!(robot.frame(robot.bodies()[1]).is_ok());
    /// assert!(robot.frame("gripper").is_err());
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn frame(&self, name: &str) -> Result<Frame, Error> {
        let frames = &self.inner.frames;
        let known = || listed(frames.iter().map(|frame| frame.name.as_str()));
        frames.iter().find(|frame| frame.name == name).cloned().ok_or_else(|| Error::NoSuchFrame { name: name.to_owned(), known: known() })
    }

    /// The names of all frames: those of the bodies first.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("humanoid")?;
    /// assert!(robot.frames().len() >= robot.bodies().len());
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn frames(&self) -> Vec<&str> {
        self.inner.frames.iter().map(|frame| frame.name.as_str()).collect()
    }

    /// What the import left out or altered, and what is unphysical about the numbers; empty if nothing is.
    ///
    /// ```
    /// assert!(featherbench_rbd::Robot::generated("humanoid")?.notes().is_empty());
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn notes(&self) -> &[String] {
        &self.inner.notes
    }

    /// The canonical description: fixed joints merged, bodies in depth-first order.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=5")?;
    /// assert_eq!(robot.description().bodies[4].parent, Some(3));
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn description(&self) -> &Description {
        &self.inner.description
    }

    /// The compiled model, which the kernels of [`dynamics`](crate::dynamics) take.
    ///
    /// ```
    /// use featherbench_rbd::dynamics::energy;
    /// let robot = featherbench_rbd::Robot::generated("chain:n=5")?;
    /// assert_eq!(energy(robot.model(), &robot.neutral(), &[0.0; 5])?.kinetic, 0.0);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn model(&self) -> &Model<f64> {
        &self.inner.model
    }

    /// The neutral description file as a text.
    ///
    /// ```
    /// use featherbench_rbd::{Robot, formats::neutral};
    /// let robot = Robot::generated("chain:n=5")?;
    /// assert_eq!(&neutral::parse(&robot.to_json()?, "chain.json")?, robot.description());
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Neutral`] when the description cannot be written.
    pub fn to_json(&self) -> Result<String, Error> {
        Ok(neutral::to_string(self.description())?)
    }

    /// The robot as MJCF, MuJoCo's format. What the format lacks is an error that names it.
    ///
    /// # Errors
    /// [`ExportError`](featherbench_formats::ExportError).
    ///
    /// ```
    /// let (text, losses) = featherbench_rbd::Robot::generated("chain:n=5")?.to_mjcf()?;
    /// assert!(text.contains("<mujoco") && losses.is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn to_mjcf(&self) -> Result<(String, Vec<featherbench_formats::Loss>), featherbench_formats::ExportError> {
        mjcf::to_string(self.description(), featherbench_formats::OnLoss::Refuse)
    }

    /// A workspace of this robot: calls on it do not allocate.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=5")?;
    /// let mut workspace = robot.workspace();
    /// let mut tau = [0.0; 5];
    /// workspace.inverse_dynamics(&robot.neutral(), &[0.0; 5], &[0.0; 5], None, &mut tau)?;
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn workspace(&self) -> Workspace {
        Workspace::new(self)
    }

    /// Many states at once, in double precision, on one core; [`Batch::on_all_cores`] takes all.
    ///
    /// Arrays hold state after state. Wrenches of a batch are one per *compiled* body, see [`Batch`].
    ///
    /// ```
    /// use featherbench_rbd::Robot;
    /// let robot = Robot::generated("chain:n=5")?;
    /// let q = robot.random_batch(1000, 7);
    /// let (zero, mut tau) = (vec![0.0; 5000], vec![0.0; 5000]);
    /// robot.batch().on_all_cores().inverse_dynamics(&q, &zero, &zero, None, &mut tau)?;
    /// let one = robot.inverse_dynamics(&q[4995..], &zero[..5], &zero[..5])?;
    /// assert!(one.iter().zip(&tau[4995..]).all(|(one, of_batch)| (one - of_batch).abs() < 1e-12 * (1.0 + one.abs())));
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn batch(&self) -> Batch<'_, f64> {
        Batch::new(self.model())
    }

    /// The same in single precision.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=2")?;
    /// let mut tau = [0.0_f32; 4];
    /// robot.batch_f32().inverse_dynamics(&[0.1_f32; 4], &[0.0; 4], &[0.0; 4], None, &mut tau)?;
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn batch_f32(&self) -> Batch<'static, f32> {
        Batch::of_model(self.model().lift())
    }
}

/// The most names that an error lists.
const LISTED: usize = 20;

/// Names for an error.
fn listed<'a>(names: impl ExactSizeIterator<Item = &'a str>) -> String {
    let count = names.len();
    let mut text = names.take(LISTED).map(|name| format!("'{name}'")).collect::<Vec<_>>().join(", ");
    if count > LISTED {
        text += &format!(" and {} more", count - LISTED);
    }
    text
}
