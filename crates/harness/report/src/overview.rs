//! The words of a run, each list in the order of the page: its engines, its robots by family, its studies.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_results::{Row, RunInfo};
use serde::Serialize;

use crate::figure::{Style, style};
use crate::labels;

/// Characters of a name in an address: file systems allow 255 bytes.
const LONGEST: usize = 120;

/// The engine of rows about all engines together.
pub const EVERYONE: &str = "all";

/// A robot on the page.
#[derive(Clone, Debug, Serialize)]
pub struct Robot<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its family.
    pub family: &'a str,
    /// Degrees of freedom.
    pub nv: Option<u64>,
    /// Moving bodies.
    pub bodies: Option<u64>,
    /// Longest path.
    pub depth: Option<u64>,
}

/// The pages of engines, robots and studies, by index: addresses in the report's folder.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Pages {
    /// `engines/NAME.html`.
    pub engines: Vec<String>,
    /// `robots/NAME.html`.
    pub robots: Vec<String>,
    /// `studies/NAME.html`.
    pub studies: Vec<String>,
}

/// The words of a run. Sections and scripts name an engine or a robot by its index here.
#[derive(Debug, Serialize)]
pub struct Overview<'a> {
    /// Names of the engines, also of those that failed to answer.
    pub engines: Vec<&'a str>,
    /// How each looks in every drawing.
    #[serde(skip)]
    pub styles: Vec<Style>,
    /// Robots, families together.
    pub robots: Vec<Robot<'a>>,
    /// Studies, in alphabetical order.
    pub studies: Vec<&'a str>,
    /// The page of each engine, robot and study.
    pub pages: Pages,
    /// The quantities of the run, with their text.
    pub titles: BTreeMap<&'a str, &'a str>,
    #[serde(skip)]
    robot_index: BTreeMap<&'a str, usize>,
}

impl<'a> Overview<'a> {
    /// Collects the words of a run and of its rows.
    pub fn of(run: &'a RunInfo, rows: &'a [Row]) -> Self {
        let met = rows.iter().map(|row| row.engine.as_str()).filter(|&name| name != EVERYONE);
        let engines = in_order(run.engines.iter().map(|engine| engine.name.as_str()), met);
        let robots = robots(run, rows);
        let robot_index = robots.iter().enumerate().map(|(index, robot)| (robot.name, index)).collect();
        let studies: BTreeSet<&str> = rows.iter().map(|row| row.study.as_str()).collect();
        let studies: Vec<&str> = studies.into_iter().collect();
        let styles = engines.iter().map(|engine| style(engine)).collect();
        let names: Vec<&str> = robots.iter().map(|robot| robot.name).collect();
        let pages =
            Pages { engines: addresses("engines", &engines), robots: addresses("robots", &names), studies: addresses("studies", &studies) };
        let titles = rows.iter().map(|row| (row.quantity.as_str(), labels::quantity(&row.quantity))).collect();
        Self { engines, styles, robots, studies, pages, titles, robot_index }
    }

    /// The index of a study.
    pub fn study(&self, name: &str) -> Option<usize> {
        self.studies.binary_search(&name).ok()
    }

    /// The index of a robot.
    pub fn robot(&self, name: &str) -> Option<usize> {
        self.robot_index.get(name).copied()
    }

    /// The index of an engine.
    pub fn engine(&self, name: &str) -> Option<usize> {
        self.engines.iter().position(|&engine| engine == name)
    }

    /// The name of the chunk with a row: its robot's, or its study's if it has no robot.
    pub fn chunk_of(&self, row: &Row) -> String {
        match self.robot(&row.robot) {
            Some(robot) => robot_chunk(robot),
            None => format!("study-{}", self.studies.iter().position(|&study| study == row.study).unwrap_or_default()),
        }
    }

    /// Groups of robots that stand beside each other and have one family, from indices in ascending order.
    pub fn families(&self, robots: impl IntoIterator<Item = usize>) -> Vec<Vec<usize>> {
        let mut families: Vec<Vec<usize>> = Vec::new();
        for robot in robots {
            match families.last_mut().filter(|family| self.robots[family[0]].family == self.robots[robot].family) {
                Some(family) => family.push(robot),
                None => families.push(vec![robot]),
            }
        }
        families
    }
}

/// The name of the chunk with a robot's rows.
pub fn robot_chunk(robot: usize) -> String {
    format!("robot-{robot}")
}

/// Addresses in a folder that differ even where a file system takes capitals for small letters. A name may hold any character: only letters,
/// digits and a few signs are kept.
fn addresses(folder: &str, names: &[&str]) -> Vec<String> {
    let mut taken = BTreeSet::new();
    let mut address = |name: &&str| {
        let kept = |c: char| if c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '+') { c } else { '_' };
        let plain: String = name.chars().map(kept).take(LONGEST).collect();
        let mut stems =
            (1..=names.len() + 1).map(|copy| if copy == 1 && !plain.is_empty() { plain.clone() } else { format!("{plain}~{copy}") });
        // Of so many names, one is free.
        let free = stems.find(|stem| !taken.contains(&stem.to_ascii_lowercase())).unwrap_or_default();
        taken.insert(free.to_ascii_lowercase());
        format!("{folder}/{free}.html")
    };
    names.iter().map(&mut address).collect()
}

/// The announced names, then the others in alphabetical order.
fn in_order<'a>(announced: impl Iterator<Item = &'a str>, met: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for name in announced {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let met: BTreeSet<&str> = met.filter(|name| !name.is_empty()).collect();
    let others: Vec<&str> = met.into_iter().filter(|name| !names.contains(name)).collect();
    names.extend(others);
    names
}

/// A row of each robot, of the family that most of its rows have: a suite may have a robot in several families.
fn typical_rows(rows: &[Row]) -> BTreeMap<&str, &Row> {
    let mut families: BTreeMap<&str, Vec<(&Row, usize)>> = BTreeMap::new();
    for row in rows.iter().filter(|row| !row.robot.is_empty()) {
        let known = families.entry(&row.robot).or_default();
        match known.iter_mut().find(|(other, _)| other.family == row.family) {
            Some((_, count)) => *count += 1,
            None => known.push((row, 1)),
        }
    }
    // Of families with equally many rows, the first.
    let typical = families.into_iter().map(|(robot, known)| (robot, known.into_iter().rev().max_by_key(|&(_, count)| count)));
    typical.filter_map(|(robot, found)| Some((robot, found?.0))).collect()
}

/// Every robot that is announced or has rows: families together, otherwise in the order of the announcement.
fn robots<'a>(run: &'a RunInfo, rows: &'a [Row]) -> Vec<Robot<'a>> {
    let typical = typical_rows(rows);
    let names = in_order(run.robots.iter().map(|robot| robot.name.as_str()), typical.keys().copied());
    let announced: BTreeMap<&str, _> = run.robots.iter().map(|robot| (robot.name.as_str(), robot)).collect();
    let mut robots: Vec<Robot> = names
        .into_iter()
        .map(|name| {
            let row = typical.get(name);
            let info = announced.get(name);
            let size = |of_info: fn(&featherbench_results::RobotInfo) -> u64, of_row: fn(&Row) -> Option<u64>| {
                info.map(|info| of_info(info)).or_else(|| row.and_then(|row| of_row(row)))
            };
            Robot {
                name,
                family: row.map_or_else(|| info.map_or("", |info| info.origin.as_str()), |row| row.family.as_str()),
                nv: size(|info| info.nv, |row| row.nv),
                bodies: size(|info| info.bodies, |row| row.bodies),
                depth: size(|info| info.depth, |row| row.depth),
            }
        })
        .collect();
    let mut families: Vec<&str> = Vec::new();
    for robot in &robots {
        if !families.contains(&robot.family) {
            families.push(robot.family);
        }
    }
    robots.sort_by_key(|robot| families.iter().position(|&family| family == robot.family));
    robots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_plain_and_differ() {
        let names = ["panda", "a/b", "a.b", "Panda", "../x", ""];
        let found = addresses("robots", &names);
        let expected = ["panda", "a_b", "a_b~2", "Panda~2", "___x", "~1"].map(|stem| format!("robots/{stem}.html"));
        assert_eq!(found, expected);
    }
}
