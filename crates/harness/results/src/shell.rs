//! The command that makes a row again, and command lines as text: words that are quoted where they must be, and read back.

use crate::RunInfo;

/// A word as a shell takes it.
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./=:,+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) { word.to_owned() } else { format!("'{}'", word.replace('\'', "'\"'\"'")) }
}

/// The words of a text: split at blanks; quotes of either kind keep blanks in a word.
///
/// # Errors
/// A sentence, when a quote is not closed.
pub fn words(text: &str) -> Result<Vec<String>, String> {
    let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
    for c in text.chars() {
        match quote {
            Some(end) if c == end => quote = None,
            None if c == '"' || c == '\'' => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            None if c.is_whitespace() => words.extend(word.take()),
            _ => word.get_or_insert_default().push(c),
        }
    }
    if let Some(open) = quote {
        return Err(format!("a quote {open} is not closed in {text}"));
    }
    words.extend(word);
    Ok(words)
}

/// Options of a run that say where it was written and how much of it: each with its value.
const OF_THE_RUN: [&str; 4] = ["--filter", "--out", "--shard", "--costs"];
/// Options that continue a run.
const CONTINUING: [&str; 2] = ["--resume", "--allow-mixed"];

impl RunInfo {
    /// The command that makes a row again: that of the run, with a filter that leaves the study of the robot. The row compares an answer
    /// with those of others, so the others are asked too.
    ///
    /// # Errors
    /// A sentence, when the run's own command has a quote that is not closed.
    pub fn again(&self, study: &str, robot: &str) -> Result<String, String> {
        let all = words(&self.command)?;
        let (program, given) = all.split_at(all.iter().position(|word| word == "--").map_or(0, |at| at + 1));
        let mut kept: Vec<String> = Vec::new();
        let mut words = given.iter();
        while let Some(word) = words.next() {
            if OF_THE_RUN.contains(&word.as_str()) {
                words.next();
            } else if !CONTINUING.contains(&word.as_str()) && !OF_THE_RUN.iter().any(|option| word.starts_with(&format!("{option}="))) {
                kept.push(word.clone());
            }
        }
        let has = |kept: &[String], option: &str| kept.iter().any(|word| word == option || word.starts_with(&format!("{option}=")));
        // A comparison of files has no filter: it is made again as a whole.
        if !has(&kept, "compare") {
            if !has(&kept, "run") {
                kept.push("run".into());
            }
            if !has(&kept, "--suite") && self.suite != "default" {
                kept.extend(["--suite".into(), self.suite.clone()]);
            }
            if !has(&kept, "--live") && self.live {
                kept.push("--live".into());
            }
            // Cells that belong to no robot, or draw one, are known by their study.
            let of_study = robot.is_empty() || study == "repeatability";
            let robot = if of_study { String::new() } else { format!("{}/", regex_lite::escape(robot)) };
            kept.extend(["--filter".into(), format!("^{study}/{robot}")]);
        }
        Ok(program.iter().chain(&kept).map(|word| quoted(word)).collect::<Vec<_>>().join(" "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_quoted_is_read_back() {
        let list = ["run", "", "a b", "mine=sh 'my oracle.sh'", "x=\"a 'b'\"", "^agreement/panda/", "(a|b)$", "it's", "a\\b"];
        let line = list.map(quoted).join(" ");
        assert_eq!(words(&line).unwrap(), list);
        assert_eq!(quoted("--suite"), "--suite");
        assert!(words("a 'b").unwrap_err().contains("is not closed"));
    }

    fn of(command: &str, live: bool, suite: &str) -> String {
        let info = RunInfo { command: command.into(), live, suite: suite.into(), ..RunInfo::default() };
        info.again("agreement", "tree_0.3").unwrap()
    }

    #[test]
    fn the_command_keeps_what_the_answer_depends_on() {
        let only = "--filter '^agreement/tree_0\\.3/'";
        assert_eq!(of("cargo run --release --", false, "default"), format!("cargo run --release -- run {only}"));
        assert_eq!(
            of("cargo run --release -- run --suite smoke --live --seed 3 --filter 'x|y' --out a --resume", true, "smoke"),
            format!("cargo run --release -- run --suite smoke --live --seed 3 {only}")
        );
        assert_eq!(of("run --filter=x --out=a --allow-mixed", true, "smoke"), format!("run --suite smoke --live {only}"));
        let external = "run --engine 'mine=sh '\"'\"'my oracle.sh'\"'\"''";
        assert_eq!(of(external, false, "default"), format!("{external} {only}"));
        assert_eq!(of("compare 'my robot.urdf' --floating --out x", true, "compare"), "compare 'my robot.urdf' --floating");
    }
}
