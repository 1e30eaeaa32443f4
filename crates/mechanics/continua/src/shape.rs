//! Where the bodies of a continuum are.

use crate::{Continuum, Defect, Refused, Solver, Tip};
use featherbench_dynamics::{DimensionError, Kinematics};
use featherbench_model::Placement;
use featherbench_spatial::{Angle, Lift, Transform};

impl Continuum {
    /// The placement in the world of a rod's end.
    ///
    /// # Errors
    /// [`Refused`]: there is no such body, or `s` does not fit.
    pub fn place<T: Angle>(&self, s: &[T], tip: &Tip) -> Result<Transform<T>, Refused>
    where
        f64: Lift<T>,
    {
        let (body, on_body) = self.compiled(tip.body)?;
        let fits = |error: DimensionError| Refused::new("s", Defect::Tree { reason: error.to_string() });
        let kinematics = self.kinematics(s).map_err(fits)?;
        let world = kinematics.body(body).map_or(Transform::identity(), |motion| motion.placement);
        Ok(world.compose(&on_body.to_transform().lift()).compose(&tip.placement.to_transform().lift()))
    }

    /// The placements of all bodies of the assembly in the world, in their order; bodies that are part of the world have the identity.
    ///
    /// # Errors
    /// [`DimensionError`] when `s` does not fit.
    pub fn shape(&self, s: &[f64]) -> Result<Vec<Transform<f64>>, DimensionError> {
        let kinematics = self.kinematics(s)?;
        let place = |place: &Option<(usize, Placement)>| {
            let (body, on_body) = (*place)?;
            Some(kinematics.body(body)?.placement.compose(&on_body.to_transform()))
        };
        Ok(self.places.iter().map(|x| place(x).unwrap_or(Transform::identity())).collect())
    }

    fn kinematics<T: Angle>(&self, s: &[T]) -> Result<Kinematics<T>, DimensionError>
    where
        f64: Lift<T>,
    {
        let zeros = vec![T::zero(); self.topology().nv()];
        let mut solver = Solver::new(self);
        solver.embed(self, s, &zeros, &zeros)?;
        let mut kinematics = Kinematics::new(&self.model().topology);
        kinematics.run(self.model(), &solver.q, &solver.v, &solver.a)?;
        Ok(kinematics)
    }
}
