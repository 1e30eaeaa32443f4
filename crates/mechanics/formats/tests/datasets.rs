//! The committed robots: they can be read, are canonical, were written by this version, and quote the licence that allows their use.

use featherbench_formats::neutral;
use featherbench_model::Model;
use std::path::{Path, PathBuf};

/// Name, nq, nv.
const ROBOTS: [(&str, usize, usize); 15] = [
    ("g1", 36, 35),
    ("g1_with_hands", 50, 49),
    ("anymal_c", 19, 18),
    ("solo12", 19, 18),
    ("bolt", 13, 12),
    ("hyq", 19, 18),
    ("simple_humanoid", 36, 35),
    ("centauro", 46, 45),
    ("panda", 9, 9),
    ("xarm7", 7, 7),
    ("so101", 6, 6),
    ("baxter", 19, 19),
    ("ur5", 6, 6),
    ("allegro_right", 16, 16),
    ("kinova", 6, 6),
];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../datasets/models")
}

#[test]
fn real_robots_are_whole() {
    let readme = std::fs::read_to_string(folder().join("README.md")).expect("the folder has a README");
    for (name, nq, nv) in ROBOTS {
        let path = folder().join(format!("{name}.json"));
        let robot = neutral::read(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((robot.name.as_str(), robot.nq(), robot.nv()), (name, nq, nv));
        assert_eq!(robot.canonical().as_ref(), Ok(&robot), "{name} is canonical");
        assert!(Model::<f64>::build(&robot).is_ok_and(|model| model.warnings.is_empty()), "{name} is physical");

        let provenance = robot.provenance.as_ref().unwrap_or_else(|| panic!("{name} has no provenance"));
        assert!(provenance.source.starts_with("PyPI example-robot-data 6.0.0, share/"), "{name}: {}", provenance.source);
        for words in [&provenance.licence, &provenance.header, &provenance.readme] {
            assert!(!words.is_empty(), "{name}: who allows its use?");
        }
        let file = provenance.source.rsplit("robots/").next().unwrap_or_default();
        assert!(readme.contains(&format!("| `{name}` |")) && readme.contains(file), "{name} is in the README's table");

        let text = std::fs::read_to_string(&path).expect("read above");
        assert_eq!(neutral::to_string(&robot).as_ref(), Ok(&text), "{name} is what this version writes");
    }
}

#[test]
fn every_description_is_readable_and_the_folder_small() {
    let (mut count, mut size) = (0, 0);
    for entry in std::fs::read_dir(folder()).expect("the folder exists") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|extension| extension == "json") {
            neutral::read(&path).unwrap_or_else(|error| panic!("{error}"));
            size += path.metadata().expect("a file").len();
            count += 1;
        }
    }
    assert!(count >= 40, "{count} robots");
    assert!(size < 600_000, "{size} bytes of robots");
}
