//! Single bodies: inclines, a sphere that begins to roll, Painlevé's rod, a block that rocks, a ball that bounces.

use super::{Measure, Question, SHORT_STEPS, STEPS, level};
use crate::scene::{Body, Scene};
use nalgebra::Vector3;
use serde::Serialize;
use serde_json::json;

/// A sled on four feet on a slope. The ground is level and gravity is turned, so that heading 0 is along x and 90° along y.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Incline {
    /// θ, rad.
    pub slope: f64,
    /// μ.
    pub friction: f64,
    /// φ of the fall line from x, rad.
    pub heading: f64,
    /// kg.
    pub mass: f64,
    /// Half of the distance between feet, m.
    pub half: f64,
    /// Height of the centre of mass, m.
    pub height: f64,
    /// m/s².
    pub gravity: f64,
}

/// How long inclines run, s.
const INCLINE: f64 = 0.4;

impl Incline {
    /// 40° and μ = ½: it slides with 2.548 m/s².
    pub fn sliding() -> Self {
        Self { slope: 40.0_f64.to_radians(), friction: 0.5, heading: 0.0, mass: 1.0, half: 0.5, height: 0.1, gravity: 9.81 }
    }

    /// 20° and μ = ½: it sticks.
    pub fn sticking() -> Self {
        Self { slope: 20.0_f64.to_radians(), ..Self::sliding() }
    }

    /// Whether it slides.
    pub fn slides(&self) -> bool {
        self.slope.tan() > self.friction
    }

    /// The question: the friction felt along the fall line over μ where it slides, else the speed with which it creeps.
    ///
    /// The second measure is the mean height of the centre of mass over that at the start, where it is higher: some models lift what slides.
    ///
    /// The felt friction is (g sin θ − 2 s/T²)/(g cos θ)/μ with the way s along the fall line from rest.
    pub fn question(&self) -> Question {
        let (sine, cosine) = self.slope.sin_cos();
        let fall = Vector3::new(self.heading.cos(), self.heading.sin(), 0.0);
        let foot = |x: f64, y: f64| [x * self.half, y * self.half, FOOT - self.height];
        let mut sled = Body::new("sled", self.mass, self.mass * self.half * self.half / 2.0, [0.0, 0.0, self.height]);
        for (x, y) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
            sled = sled.with_sphere(FOOT, foot(x, y));
        }
        let gravity = self.gravity * (sine * fall - cosine * Vector3::z());
        let Self { gravity: g, friction, .. } = *self;
        let felt = move |way: f64| (g * sine - 2.0 * way / (INCLINE * INCLINE)) / (g * cosine) / friction;
        let measure = if self.slides() {
            Measure::new("felt_friction", "1", 1.0, 1.0, move |motion| felt(motion.position(motion.last(), 0).dot(&fall)))
        } else {
            // Between the half and the end: what moves before is the contacts' settling.
            Measure::new("creep", "m/s", 0.0, 1.0, move |motion| {
                let (middle, last) = (motion.samples() / 2, motion.last());
                let way = (motion.position(last, 0) - motion.position(middle, 0)).dot(&fall);
                way / (INCLINE * (last - middle) as f64 / motion.samples() as f64)
            })
        };
        let height = self.height;
        let lift = Measure::new("lift", "m", 0.0, 1.0, move |motion| {
            let heights = (0..motion.samples()).map(|sample| (motion.position(sample, 0).z - height).max(0.0));
            heights.sum::<f64>() / motion.samples() as f64
        });
        let name = if self.slides() { format!("incline_{:.0}", self.heading.to_degrees()) } else { "incline_sticking".into() };
        Question {
            scene: Scene { name, gravity: gravity.into(), friction: self.friction, restitution: 0.0, bodies: vec![sled] },
            duration: INCLINE,
            dts: STEPS,
            measures: vec![measure, lift],
            params: json!(self),
        }
    }
}

/// The radius of a foot, m.
const FOOT: f64 = 0.02;

/// A sphere that slides and begins to roll.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sliding {
    /// v₀, m/s.
    pub speed: f64,
    /// μ.
    pub friction: f64,
    /// m.
    pub radius: f64,
    /// m/s².
    pub gravity: f64,
    /// s; it must be beyond 2v₀/(7 μ g).
    pub duration: f64,
}

impl Default for Sliding {
    /// 5 m/s, μ = 0.3: it rolls after 0.485 s with 25/7 m/s.
    fn default() -> Self {
        Self { speed: 5.0, friction: 0.3, radius: 0.5, gravity: 9.81, duration: 0.8 }
    }
}

impl Sliding {
    /// When it begins to roll, s.
    pub fn rolls_at(&self) -> f64 {
        2.0 * self.speed / (7.0 * self.friction * self.gravity)
    }

    /// The question: its speed when it rolls, and the way that it has then, v₀ t* − ½ μ g t*² + (5/7) v₀ (T − t*).
    pub fn question(&self) -> Question {
        let mut ball = Body::ball("ball", 1.0, self.radius, [0.0, 0.0, self.radius]);
        ball.linear[0] = self.speed;
        let (rolling, start) = (5.0 / 7.0 * self.speed, self.rolls_at());
        let way = self.speed * start - self.friction * self.gravity * start * start / 2.0 + rolling * (self.duration - start);
        Question {
            scene: level("sliding_sphere", self.gravity, self.friction, vec![ball]),
            duration: self.duration,
            dts: STEPS,
            measures: vec![
                Measure::new("rolling_speed", "m/s", rolling, rolling, |motion| motion.linear(motion.last(), 0).x),
                Measure::new("way", "m", way, way, |motion| motion.position(motion.last(), 0).x),
            ],
            params: json!(self),
        }
    }
}

/// Painlevé's rod: its lower tip slides ahead of the centre of mass. See `featherbench_contact::systems::PainleveRod`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rod {
    /// Half of its length, m; the mass is 1 kg.
    pub half: f64,
    /// θ to the ground, rad.
    pub angle: f64,
    /// μ.
    pub friction: f64,
    /// The tip's speed, m/s.
    pub slip: f64,
    /// m/s².
    pub gravity: f64,
}

impl Default for Rod {
    /// tan θ = 2 and μ = 1.5, not turning: no force obeys the laws.
    fn default() -> Self {
        Self { half: 1.0, angle: 2.0_f64.atan(), friction: 1.5, slip: 1.0, gravity: 9.81 }
    }
}

impl Rod {
    /// The question: the tip's speed along the ground after 20 ms over that at the start. An impact without collision stops it at once. The
    /// second measure is the height of the tip: it must not be below the ground.
    pub fn question(&self) -> Question {
        let (sine, cosine) = self.angle.sin_cos();
        let tip = Vector3::new(self.half * cosine, 0.0, TIP - self.half * sine);
        let mut rod = Body::new("rod", 1.0, self.half * self.half / 3.0, [0.0, 0.0, self.half * sine]).with_sphere(TIP, tip.into());
        rod.linear[0] = self.slip;
        let slip = self.slip;
        Question {
            scene: level("painleve_rod", self.gravity, self.friction, vec![rod]),
            duration: 0.02,
            dts: SHORT_STEPS,
            measures: vec![
                Measure::new("tip_slip", "1", 0.0, 1.0, move |motion| {
                    let last = motion.last();
                    // The point of the sphere that touches, not its centre.
                    let arm = motion.orientation(last, 0) * tip - TIP * Vector3::z();
                    (motion.linear(last, 0) + motion.angular(last, 0).cross(&arm)).x / slip
                }),
                Measure::new("penetration", "m", 0.0, 1.0, move |motion| {
                    let last = motion.last();
                    let lowest = (motion.position(last, 0) + motion.orientation(last, 0) * tip).z - TIP;
                    if lowest < 0.0 { -lowest } else { 0.0 * lowest }
                }),
            ],
            params: json!(self),
        }
    }
}

/// The radius of the rod's tip, m.
const TIP: f64 = 0.01;

/// A block that rocks from one foot to the other. Its feet are small spheres, so that all engines see the same contacts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Block {
    /// b, half of the width between feet, m.
    pub half_width: f64,
    /// h, height of the centre of mass, m.
    pub half_height: f64,
    /// The angle at the start, rad.
    pub angle: f64,
    /// Its rate towards the other foot, rad/s.
    pub rate: f64,
    /// μ: enough to hold the feet.
    pub friction: f64,
    /// m/s².
    pub gravity: f64,
}

impl Default for Block {
    /// b/h = ¼: r = 31/34.
    fn default() -> Self {
        Self { half_width: 0.25, half_height: 1.0, angle: 0.02, rate: 0.5, friction: 1.0, gravity: 9.81 }
    }
}

impl Block {
    /// Housner's r = ω⁺/ω⁻ = 1 − 2 m b²/I_O, with I_O = 4/3 m (b² + h²) about a foot.
    pub fn ratio(&self) -> f64 {
        let (b, h) = (self.half_width * self.half_width, self.half_height * self.half_height);
        1.0 - 1.5 * b / (b + h)
    }

    /// The question: how much energy, above that upright at rest, the impact leaves.
    pub fn question(&self) -> Question {
        let (b, h, g) = (self.half_width, self.half_height, self.gravity);
        let moment = (b * b + h * h) / 3.0;
        // It stands turned about the foot's centre at +b. That sphere stays on the ground.
        let turn = Vector3::new(0.0, self.angle, 0.0);
        let rotation = nalgebra::UnitQuaternion::from_scaled_axis(turn);
        let (right, pivot) = (Vector3::new(b, 0.0, FOOT - h), Vector3::new(b, 0.0, FOOT));
        let centre = pivot - rotation * right;
        let angular = Vector3::new(0.0, -self.rate, 0.0);
        let contact = Vector3::new(b, 0.0, 0.0);
        let mut block = Body::new("block", 1.0, moment, centre.into());
        for (x, y) in [(b, b), (-b, b), (-b, -b), (b, -b)] {
            block = block.with_sphere(FOOT, [x, y, FOOT - h]);
        }
        let turn = rotation.coords;
        block.orientation = [turn[0], turn[1], turn[2], turn[3]];
        block.angular = angular.into();
        block.linear = angular.cross(&(centre - contact)).into();
        let speed = angular.cross(&(centre - contact)).norm_squared();
        let energy = move |height: f64, linear: f64, angular: f64| g * (height - h) + linear / 2.0 + moment * angular / 2.0;
        let start = energy(centre.z, speed, angular.norm_squared());
        Question {
            scene: level("rocking_block", g, self.friction, vec![block]),
            duration: 0.08,
            dts: SHORT_STEPS,
            measures: vec![Measure::new("energy_ratio", "1", self.ratio().powi(2), 1.0, move |motion| {
                let last = motion.last();
                let (linear, angular) = (motion.linear(last, 0), motion.angular(last, 0));
                energy(motion.position(last, 0).z, linear.norm_squared(), angular.norm_squared()) / start
            })],
            params: json!(self),
        }
    }
}

/// A ball that falls and bounces once.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bounce {
    /// Height of its lowest point, m.
    pub height: f64,
    /// e.
    pub restitution: f64,
    /// m.
    pub radius: f64,
    /// m/s².
    pub gravity: f64,
}

impl Default for Bounce {
    /// 1 m, e = 0.8: it lands after 0.452 s.
    fn default() -> Self {
        Self { height: 1.0, restitution: 0.8, radius: 0.1, gravity: 9.81 }
    }
}

impl Bounce {
    /// The question: the root of the energy after the impact over that before, which is e.
    pub fn question(&self) -> Question {
        let Self { height, restitution, radius, gravity } = *self;
        let ball = Body::ball("ball", 1.0, radius, [0.0, 0.0, radius + height]);
        let lands = (2.0 * height / gravity).sqrt();
        Question {
            scene: Scene { name: "bouncing_ball".into(), gravity: [0.0, 0.0, -gravity], friction: 0.5, restitution, bodies: vec![ball] },
            // Half of the flight after it.
            duration: lands * (1.0 + restitution / 2.0),
            dts: STEPS,
            measures: vec![Measure::new("felt_restitution", "1", restitution, 1.0, move |motion| {
                let last = motion.last();
                let energy = gravity * (motion.position(last, 0).z - radius) + motion.linear(last, 0).norm_squared() / 2.0;
                (energy / (gravity * height)).sqrt()
            })],
            params: json!(self),
        }
    }
}
