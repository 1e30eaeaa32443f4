//! Robots that a suite draws: as many as one number says, each at a drawn level of every axis.

use crate::RobotEntry;
use featherbench_robots::Random;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// The axis that is no parameter of the family: the factor on the velocities of the state.
const SPEED: &str = "speed";

/// The table `[draw]` of a suite. Robot k depends on the suite's seed and on k alone: a larger draw begins with the robots of a smaller one.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Draw {
    /// The number of robots.
    pub size: usize,
    /// The family of generated robots, one that has a parameter `seed`.
    pub generate: String,
    /// The levels of each axis, equally likely: the parameters of the family, and `speed`.
    pub axes: BTreeMap<String, Vec<Value>>,
}

impl Draw {
    /// What is wrong with it beyond its keys.
    pub(crate) fn complaint(&self) -> Option<String> {
        if self.axes.is_empty() {
            return Some("[draw]: there are no axes; give for example axes.n = [2, 4, 8]".into());
        }
        let good = |axis: &str, level: &Value| level.is_number() || (axis != SPEED && level.is_string());
        let bad = self.axes.iter().find(|(axis, levels)| levels.is_empty() || !levels.iter().all(|level| good(axis, level)));
        bad.map(|(axis, _)| format!("[draw]: axes.{axis} must be a list of levels, numbers or (but for {SPEED}) words"))
    }

    /// The robots.
    pub fn robots(&self, seed: u64) -> impl Iterator<Item = RobotEntry> + '_ {
        (0..self.size).map(move |k| self.robot(seed, k))
    }

    fn robot(&self, seed: u64, k: usize) -> RobotEntry {
        // Each axis has its own stream: one more axis changes no other.
        let level = |(axis, levels): (&String, &Vec<Value>)| {
            let at = Random::named(seed, &format!("draw/{k}/{axis}")).below(levels.len());
            levels.get(at).map(|level| (axis.clone(), level.clone()))
        };
        let axes: BTreeMap<String, Value> = self.axes.iter().filter_map(level).collect();
        let mut spec = format!("{}:seed={k}", self.generate);
        for (axis, level) in axes.iter().filter(|(axis, _)| *axis != SPEED) {
            spec += &format!(",{axis}={}", level.as_str().map_or_else(|| level.to_string(), str::to_owned));
        }
        RobotEntry {
            generate: Some(spec),
            family: "draw".into(),
            speed: axes.get(SPEED).and_then(Value::as_f64),
            name: Some(format!("draw-{k}")),
            axes,
            ..RobotEntry::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::collections::BTreeSet;

    fn draw(size: usize) -> Draw {
        let axes = json!({"n": [2, 4, 8], "joints": ["revolute", "all"], "tip_scale": [1e-3, 1.0, 1e6], "speed": [1.0, 1e3]});
        Draw { size, generate: "tree".into(), axes: serde_json::from_value(axes).unwrap() }
    }

    #[test]
    fn a_larger_draw_begins_with_the_smaller_one_and_has_every_level() {
        let (small, large): (Vec<_>, Vec<_>) = (draw(7).robots(1).collect(), draw(60).robots(1).collect());
        assert_eq!(small[..], large[..7]);
        assert_ne!(small, draw(7).robots(2).collect::<Vec<_>>(), "the seed counts");
        for (axis, levels) in &draw(1).axes {
            let met: BTreeSet<String> = large.iter().map(|robot| robot.axes[axis].to_string()).collect();
            assert_eq!(met.len(), levels.len(), "{axis}");
        }
        assert!(large.iter().all(|robot| robot.speed == robot.axes["speed"].as_f64()));
        for robot in &large {
            featherbench_robots::Family::parse(robot.generate.as_ref().unwrap()).unwrap();
        }
        let fewer = Draw { axes: draw(1).axes.into_iter().filter(|(axis, _)| axis != "joints").collect(), ..draw(60) };
        assert!(fewer.robots(1).zip(&large).all(|(a, b)| a.axes["n"] == b.axes["n"]), "an axis more changes no other");
    }
}
