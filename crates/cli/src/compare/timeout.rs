//! An engine that is asked about a robot no more once it has not answered in time. What did not come within the limit is a stated outcome,
//! and the other engines go on.

use featherbench_bench::{Engine, Evaluation, Identity, Import, ImportVariant, NoAnswer, Quantity, Rewritten, Robot, RobotFile};
use featherbench_robots::StateBatch;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The first words of the error of a process that did not answer in time.
const LATE: &str = "no answer within ";

/// An engine, and the robots that it was too slow for.
pub struct Patient {
    engine: Box<dyn Engine>,
    /// By the file, what was asked in vain, in words.
    late: Mutex<BTreeMap<PathBuf, String>>,
}

impl Patient {
    pub fn new(engine: Box<dyn Engine>) -> Self {
        Self { engine, late: Mutex::new(BTreeMap::new()) }
    }

    /// Refuses what is about a robot that the engine was too slow for.
    fn admit(&self, file: Option<&RobotFile>) -> Result<(), NoAnswer> {
        let late = self.late.lock().unwrap_or_else(PoisonError::into_inner);
        match file.and_then(|file| late.get(&file.path)) {
            Some(before) => Err(NoAnswer::NotOffered(format!("not asked again: {before}"))),
            None => Ok(()),
        }
    }

    /// Keeps that an answer did not come in time. It says nothing about the robot, so it is no failure.
    fn judged<T>(&self, file: Option<&RobotFile>, doing: &str, answer: Result<T, NoAnswer>) -> Result<T, NoAnswer> {
        match answer {
            Err(NoAnswer::Failed(reason)) if reason.starts_with(LATE) => {
                let reason = format!("{reason} ({doing})");
                if let Some(file) = file {
                    self.late.lock().unwrap_or_else(PoisonError::into_inner).insert(file.path.clone(), reason.clone());
                }
                Err(NoAnswer::NotOffered(reason))
            }
            answer => answer,
        }
    }
}

impl Engine for Patient {
    fn identity(&self) -> &Identity {
        self.engine.identity()
    }

    fn methods(&self, quantity: Quantity) -> Vec<String> {
        self.engine.methods(quantity)
    }

    fn read(&self, file: &RobotFile) -> Result<Import, NoAnswer> {
        self.admit(Some(file))?;
        self.judged(Some(file), &format!("reading the {}", file.format.name().to_uppercase()), self.engine.read(file))
    }

    fn variants(&self, file: &RobotFile) -> Result<Vec<ImportVariant>, NoAnswer> {
        self.admit(Some(file))?;
        // They are no answer about the robot: one that has too many is asked for the others all the same.
        self.judged(None, "making variants of the file", self.engine.variants(file))
    }

    fn rewrite(&self, file: &RobotFile, into: &Path) -> Result<Vec<Rewritten>, NoAnswer> {
        self.admit(Some(file))?;
        self.judged(None, "writing the file again", self.engine.rewrite(file, into))
    }

    fn prepare<'a>(
        &'a self,
        robot: &'a Robot,
        quantity: Quantity,
        method: &str,
        states: &'a StateBatch,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        let file = robot.file.as_ref();
        self.admit(file)?;
        let doing = format!("building {} bodies", robot.states.bodies);
        let prepared = self.judged(file, &doing, self.engine.prepare(robot, quantity, method, states))?;
        Ok(Box::new(Waiting { patient: self, file, quantity, prepared }))
    }
}

/// An evaluation that may not come in time.
struct Waiting<'a> {
    patient: &'a Patient,
    file: Option<&'a RobotFile>,
    quantity: Quantity,
    prepared: Box<dyn Evaluation + 'a>,
}

impl Evaluation for Waiting<'_> {
    fn run(&mut self, range: Range<usize>) -> Result<(), NoAnswer> {
        self.patient.admit(self.file)?;
        let doing = format!("{} at {} states", self.quantity.name(), range.len());
        self.patient.judged(self.file, &doing, self.prepared.run(range))
    }

    fn read(&self) -> &[f64] {
        self.prepared.read()
    }
}

#[cfg(test)]
mod tests {
    use super::{Engine, Evaluation, Identity, Import, NoAnswer, Patient, Quantity, Robot, RobotFile, StateBatch};
    use ::featherbench_results::EngineSource;
    use featherbench_bench::{FileBase, FileFormat};
    use std::collections::BTreeMap;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// An engine that refuses every file with one sentence, and counts how often it is asked.
    struct Slow {
        identity: Identity,
        reason: &'static str,
        asked: std::sync::Arc<AtomicUsize>,
    }

    impl Engine for Slow {
        fn identity(&self) -> &Identity {
            &self.identity
        }

        fn methods(&self, _: Quantity) -> Vec<String> {
            Vec::new()
        }

        fn read(&self, _: &RobotFile) -> Result<Import, NoAnswer> {
            self.asked.fetch_add(1, Ordering::Relaxed);
            Err(NoAnswer::Failed(self.reason.into()))
        }

        fn prepare<'a>(&'a self, _: &'a Robot, _: Quantity, _: &str, _: &'a StateBatch) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
            Err(NoAnswer::Failed(self.reason.into()))
        }
    }

    fn file(name: &str) -> RobotFile {
        RobotFile {
            path: name.into(),
            format: FileFormat::Urdf,
            base: FileBase::Fixed,
            hash: "0".into(),
            links: Vec::new(),
            features: Vec::new(),
        }
    }

    fn patient(reason: &'static str) -> (Patient, std::sync::Arc<AtomicUsize>) {
        let asked = std::sync::Arc::new(AtomicUsize::new(0));
        let identity = Identity { name: "slow".into(), version: "1".into(), source: EngineSource::Live, build: BTreeMap::new() };
        (Patient::new(Box::new(Slow { identity, reason, asked: asked.clone() })), asked)
    }

    #[test]
    fn who_is_late_is_not_asked_again_about_that_robot() {
        let (engine, asked) = patient("no answer within 60 s");
        let refused = |name: &str| engine.read(&file(name)).unwrap_err();
        assert_eq!(refused("a.urdf"), NoAnswer::NotOffered("no answer within 60 s (reading the URDF)".into()));
        assert_eq!(refused("a.urdf"), NoAnswer::NotOffered("not asked again: no answer within 60 s (reading the URDF)".into()));
        assert_eq!(asked.load(Ordering::Relaxed), 1);
        refused("b.urdf");
        assert_eq!(asked.load(Ordering::Relaxed), 2);
    }

    #[test]
    fn other_failures_stay_failures_and_are_asked_again() {
        let (engine, asked) = patient("line 3: no");
        for _ in 0..2 {
            assert_eq!(engine.read(&file("a.urdf")).unwrap_err(), NoAnswer::Failed("line 3: no".into()));
        }
        assert_eq!(asked.load(Ordering::Relaxed), 2);
    }
}
