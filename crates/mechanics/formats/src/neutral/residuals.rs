//! Reading and writing the section `residuals`: each law has its own numbers, and no others.

use super::write::{Writer, quoted};
use featherbench_model::{DescribedResidual, ResidualLaw};
use serde::Deserialize;

/// A residual with its law.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Entry {
    name: String,
    bodies: Vec<usize>,
    #[serde(with = "Law")]
    law: ResidualLaw,
}

#[derive(Deserialize)]
#[serde(remote = "ResidualLaw", tag = "type", rename_all = "snake_case", deny_unknown_fields)]
enum Law {
    Viscous {
        coefficient: Vec<f64>,
    },
    Coulomb {
        force: Vec<f64>,
        width: Vec<f64>,
    },
    Dry {
        force: Vec<f64>,
    },
    Stribeck {
        coulomb: Vec<f64>,
        stiction: Vec<f64>,
        speed: Vec<f64>,
        viscous: Vec<f64>,
        width: Vec<f64>,
    },
    Spring {
        stiffness: Vec<f64>,
        damping: Vec<f64>,
        rest: Vec<f64>,
    },
    SeriesElastic {
        stiffness: Vec<f64>,
        damping: Vec<f64>,
        motor: Vec<f64>,
    },
    Lag {
        time: Vec<f64>,
    },
    Delay {
        periods: usize,
    },
    Payload {
        mass: f64,
        com: [f64; 3],
        inertia: [f64; 6],
    },
    Linear {
        #[serde(default)]
        position: Vec<f64>,
        #[serde(default)]
        velocity: Vec<f64>,
        #[serde(default)]
        acceleration: Vec<f64>,
        #[serde(default)]
        constant: Vec<f64>,
    },
}

impl From<Entry> for DescribedResidual {
    fn from(Entry { name, bodies, law }: Entry) -> Self {
        Self { name, bodies, law }
    }
}

impl Writer<'_> {
    pub(super) fn residual(&mut self, DescribedResidual { name, bodies, law }: &DescribedResidual) {
        self.put(format_args!("{{\"name\":{},\"bodies\":{},\"law\":{{\"type\":\"{}\"", quoted(name), listed(bodies), law.name()));
        if let ResidualLaw::Delay { periods } = law {
            self.put(format_args!(",\"periods\":{periods}"));
        }
        for list in law.numbers() {
            match list.values {
                [] if list.optional => {}
                // A mass is a number, not a list of one.
                [value] if list.field == "mass" => self.put(format_args!(",\"mass\":{value:?}")),
                values => {
                    self.put(format_args!(",\"{}\":", list.field));
                    self.numbers(values);
                }
            }
        }
        self.push("}}");
    }
}

fn listed(bodies: &[usize]) -> String {
    format!("[{}]", bodies.iter().map(usize::to_string).collect::<Vec<_>>().join(","))
}
