//! Damaged runs: a byte of a file is flipped, a part of it is missing, or all. Each command that reads the file refuses the run and names the file.
//! One that does not read it says what it says of the whole run.
//!
//! The commands are those of `featherbench --help`, the files those that are there. Damage is drawn.

use crate::share::one_of;
use crate::support::{Ended, Sandbox};
use featherbench_robots::Random;
use std::path::{Path, PathBuf};

/// How a command reads a run: its arguments, where RUN, SHARD, ALL and CELL stand for folders and a cell. None if it reads none.
fn reading(command: &str) -> &'static [&'static [&'static str]] {
    match command {
        "explain" => &[&["explain", "CELL", "RUN"]],
        "diff" => &[&["diff", "RUN", "good/run"], &["diff", "good/run", "RUN"]],
        "gate" => &[&["gate", "RUN"], &["gate", "RUN", "--ranges"]],
        "report" => &[&["report", "RUN"]],
        "history" => &[&["history", "RUN"], &["history", "ALL"]],
        // Into a folder that is not empty: the rows are read first, and the program that writes them is not built.
        "export" => &[&["export", "RUN", "--parquet", "good"]],
        "reduce" => &[&["reduce", "RUN", "--cell", "ffffffffffff"]],
        "merge" => &[&["merge", "SHARD", "good/shard-2", "--out", "merged"]],
        "run" => &[
            &["run", "--suite", "smoke", "--no-timing", "--filter", "^operations/", "--out", "RUN", "--resume"],
            &["run", "--suite", "smoke", "--no-timing", "--filter", "^operations/", "--shard", "1/2", "--out", "SHARD", "--resume"],
        ],
        "plan" => &[
            &["plan", "smoke", "--no-timing", "--filter", "^operations/", "--costs", "RUN"],
            &["plan", "smoke", "--no-timing", "--filter", "^operations/", "--costs", "SHARD"],
        ],
        // It starts `run` and `merge` on its shards; tests/outside asks it.
        "sweep" => &[],
        "compare" | "list" | "record" | "gen" | "identify" | "residuals" | "uncertainty" | "oracles" | "completions" | "man" | "help" => {
            &[]
        }
        other => panic!("whether '{other}' reads a run is not tested"),
    }
}

/// All files below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        if entry.path().is_dir() { found.extend(files(&entry.path())) } else { found.push(entry.path()) }
    }
    found.sort();
    found
}

/// Makes a folder a copy of another.
fn copy(from: &Path, to: &Path) {
    let _ = std::fs::remove_dir_all(to);
    for file in files(from) {
        let at = to.join(file.strip_prefix(from).unwrap());
        std::fs::create_dir_all(at.parent().unwrap()).unwrap();
        std::fs::copy(&file, &at).unwrap();
    }
}

/// Damages a file, and says how; nothing if it has nothing to damage.
fn damage(path: &Path, kind: usize, random: &mut Random) -> Option<String> {
    let mut bytes = std::fs::read(path).unwrap();
    if kind == 0 {
        std::fs::remove_file(path).unwrap();
        return Some("removed".into());
    }
    if bytes.is_empty() {
        return None;
    }
    let at = random.below(bytes.len());
    let how = if kind == 1 {
        let whole = bytes.len();
        bytes.truncate(at);
        format!("cut at byte {at} of {whole}")
    } else {
        let bit = random.below(8);
        bytes[at] ^= 1 << bit;
        format!("bit {bit} of byte {at} of {}", bytes.len())
    };
    std::fs::write(path, bytes).unwrap();
    Some(how)
}

/// What a command says of copies of the good folders, after some damage.
struct Asked<'a> {
    sandbox: &'a Sandbox,
    cell: String,
    command: &'a [&'a str],
}

impl Asked<'_> {
    fn prepare(&self) {
        for name in ["run", "shard-1"] {
            copy(&self.sandbox.path("good").join(name), &self.sandbox.path("all").join(name));
        }
        for left in ["merged", "reports"] {
            let _ = std::fs::remove_dir_all(self.sandbox.path(left));
        }
    }

    fn ask(&self) -> Ended {
        let word = |word: &&str| match *word {
            "RUN" => "all/run".to_owned(),
            "SHARD" => "all/shard-1".to_owned(),
            "ALL" => "all".to_owned(),
            "CELL" => self.cell.clone(),
            other => other.to_owned(),
        };
        let words: Vec<String> = self.command.iter().map(word).collect();
        self.sandbox.run(&words.iter().map(String::as_str).collect::<Vec<_>>())
    }
}

/// Without times.
fn timeless(text: &str) -> String {
    text.lines().filter(|line| !line.contains(" s of work") && !line.contains(" s on one core")).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_damaged_file_of_a_run_is_refused_by_name_or_not_read() {
    let sandbox = Sandbox::new();
    let suite = ["run", "--suite", "smoke", "--no-timing", "--filter", "^operations/", "--out"];
    sandbox.run(&[&suite[..], &["good/run"]].concat()).expect(0, &["report:"]);
    for number in ["1", "2"] {
        let (shard, folder) = (format!("{number}/2"), format!("good/shard-{number}"));
        sandbox.run(&[&suite[..], &[&folder, "--shard", &shard]].concat()).expect(0, &["shard"]);
    }
    let (_, rows) = featherbench_results::read_run(&sandbox.path("good/run")).unwrap();
    let help = sandbox.run(&["--help"]).output;
    let listed = help.split("Commands:").nth(1).and_then(|rest| rest.split("\n\n").next()).unwrap();
    let commands: Vec<&str> = listed
        .lines()
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    let mut random = Random::named(44, "damage");
    let (mut asked, mut wrong) = (0, Vec::new());
    for way in commands.iter().flat_map(|command| reading(command)) {
        let of = Asked { sandbox: &sandbox, cell: rows[0].cell.clone(), command: way };
        of.prepare();
        let good = of.ask();
        let folder = if way.contains(&"SHARD") { "shard-1" } else { "run" };
        let all = files(&sandbox.path("good").join(folder));
        // Of the pages of the report, which no command reads, some.
        let is_page = |path: &PathBuf| {
            path.extension().is_some_and(|ending| ["html", "js", "css", "svg", "woff2"].iter().any(|page| ending == *page))
        };
        let (pages, data): (Vec<PathBuf>, Vec<PathBuf>) = all.into_iter().partition(is_page);
        for file in data.iter().chain(pages.iter().step_by(8 * one_of(8))) {
            for kind in (0..3).chain([2; 3].into_iter().take(4 - one_of(4))) {
                of.prepare();
                let name = file.strip_prefix(sandbox.path("good")).unwrap();
                let Some(how) = damage(&sandbox.path("all").join(name), kind, &mut random) else { continue };
                let found = of.ask();
                asked += 1;
                let names = found.errors.contains(name.file_name().unwrap().to_str().unwrap());
                let same = found.code == good.code && timeless(&found.output) == timeless(&good.output);
                let refused = found.code == Some(2) && names;
                // A run that goes on does again what was lost.
                let again = |name: &str| std::fs::read(sandbox.path(name).join("rows.csv")).ok();
                let mended = same
                    && match way.contains(&"--resume") {
                        true => again("all/run") == again("good/run"),
                        false => timeless(&found.errors) == timeless(&good.errors) || names,
                    };
                if !refused && !mended || found.errors.contains("panicked") {
                    wrong.push(format!("{way:?}, {}, {how}: {found:?}", name.display()));
                }
            }
        }
    }
    assert!(asked > 100, "{asked}");
    assert!(wrong.is_empty(), "{} of {asked}:\n{}", wrong.len(), wrong.join("\n"));
    println!("{asked} damaged files");
}
