//! Each attribute that MuJoCo's schema has is read, refused, told by name, or listed here as having no part in a description.
//!
//! `mjcf_schema.txt` is the schema of the pinned MuJoCo; `oracles/tests/test_import_told.py` compares it with MuJoCo's own.

use featherbench_formats::mjcf;

const SCHEMA: &str = include_str!("mjcf_schema.txt");

/// A robot on which each attribute that is read has an effect. `@NAME ` marks the element NAME; a comment is a place for others.
const ROBOT: &str = r#"<mujoco @mujoco model="m"><compiler @compiler angle="degree"><!--compiler--></compiler>
<option @option gravity="0 0 -9"><flag @option/flag /><!--option--></option>
<default @default ><joint @default/joint /><geom @default/geom size=".1"/><!--default--></default><!--mujoco-->
<worldbody><body name="base" pos=".1 .2 .3" euler="10 20 30"><joint name="lift" type="slide" axis="0 0 1" actuatorfrcrange="-5 5"/>
<inertial @body/inertial pos=".1 0 0" mass="2" diaginertia=".02 .03 .04"/><geom size=".1"/>
<body @body name="arm" pos=".3 0 0"><joint @body/joint name="turn" axis="0 .6 .8" pos="0 .1 0" range="-30 50" actuatorfrcrange="-5 5"/>
<geom @body/geom type="capsule" size=".05 .2"/><!--body--><body name="tip"><joint name="bend"/><geom/></body></body></body>
<body name="flies"><freejoint @body/freejoint /><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody></mujoco>"#;

/// Values of many kinds. One of them must do.
const VALUES: [&str; 21] = [
    "0.7",
    "3",
    "0.7 0.4",
    "-2 2",
    "1 2 3",
    "0.3 0.4 0.5 0.6",
    "0.9 0.8 0.1 0.2 0.3",
    "1 .1 0 0 .2 1",
    ".02 .03 .04 0 .001 0",
    "true",
    "false",
    "radian",
    "global",
    "yzx",
    "disable",
    "sphere",
    "box",
    "ball",
    "slide",
    "x",
    "word",
];

/// Elements that have no part in a description, with all that is in them.
const NO_PART_ELEMENTS: [&str; 11] = [
    // How the range of an actuator's length is found.
    "compiler/lengthrange",
    // Memory, appearance, statistics, words for the user, states, and files that are named elsewhere.
    "size",
    "visual",
    "statistic",
    "custom",
    "keyframe",
    "asset",
    // Places that others may name, and what is seen.
    "body/site",
    "body/camera",
    "body/light",
    // The class of what is told where it stands.
    "default",
];

/// Attributes that have no part in a description: names, appearance, numbers for the user, folders, threads.
const NO_PART: [&str; 14] = [
    "name",
    "class",
    "childclass",
    "user",
    "rgba",
    "material",
    "group",
    "assetdir",
    "meshdir",
    "texturedir",
    "strippath",
    "usethread",
    // It merges bodies that are merged in any case.
    "fusestatic",
    // Of a body with a joint. A mesh's shape is refused with or without it.
    "fitaabb",
];

/// The robot with an attribute of the element of a path. An element that it does not have is put there, with those around it.
fn with(path: &str, attribute: &str, value: &str) -> String {
    let said = format!(r#"{attribute}="{value}""#);
    let mut text = if let Some((before, after)) = ROBOT.split_once(&format!("@{path} ")) {
        let (inside, after) = after.split_once('>').unwrap();
        // What the element says already is replaced.
        let kept = match format!(" {inside}").split_once(&format!(" {attribute}=\"")) {
            Some((first, rest)) => format!("{first} {}", rest.split_once('"').unwrap().1),
            None => inside.to_owned(),
        };
        format!("{before}{said} {kept}>{after}")
    } else {
        let words: Vec<&str> = path.split('/').collect();
        let in_place = ["compiler", "option", "default", "body"].contains(&words[0]);
        let (place, rest) = if in_place { (words[0], &words[1..]) } else { ("mujoco", &words[..]) };
        let (last, around) = rest.split_last().unwrap();
        let open: String = around.iter().map(|word| format!("<{word}>")).collect();
        let close: String = around.iter().rev().map(|word| format!("</{word}>")).collect();
        ROBOT.replace(&format!("<!--{place}-->"), &format!("{open}<{last} {said}/>{close}"))
    };
    while let Some(mark) = text.find('@') {
        let end = mark + text[mark..].find(' ').unwrap();
        text.replace_range(mark..=end, "");
    }
    text
}

/// What becomes of an attribute with one value.
#[derive(Debug, PartialEq)]
enum Fate {
    Refused,
    Read,
    Told,
    Silent,
}

fn fate(path: &str, attribute: &str, value: &str) -> Fate {
    let text = with(path, attribute, value);
    let usual = mjcf::import(&with("mujoco", "model", "m"), "f.xml").unwrap();
    match mjcf::import(&text, "f.xml") {
        Err(_) => Fate::Refused,
        Ok((robot, _)) if robot != usual.0 => Fate::Read,
        Ok((_, notes)) => {
            let told = notes.iter().filter(|note| !usual.1.contains(note)).any(|note| {
                let words: Vec<&str> = note.text.split([' ', ',', '<', '>']).collect();
                words.contains(&attribute) || path.split('/').any(|element| note.text.starts_with(&format!("<{element}>")))
            });
            if told { Fate::Told } else { Fate::Silent }
        }
    }
}

#[test]
fn each_attribute_of_the_schema_is_read_refused_or_told() {
    let (mut cases, mut silent) = (0, Vec::new());
    for line in SCHEMA.lines() {
        let (path, attributes) = line.split_once(':').unwrap();
        for attribute in attributes.split_whitespace() {
            cases += 1;
            // A class of what is read is read.
            let no_part = |element: &&str| path == *element || path.starts_with(&format!("{element}/"));
            let of_class = ["default/joint", "default/geom"].contains(&path);
            if NO_PART.contains(&attribute) || (NO_PART_ELEMENTS.iter().any(no_part) && !of_class) {
                continue;
            }
            if VALUES.iter().all(|value| fate(path, attribute, value) == Fate::Silent) {
                silent.push(format!("{path} {attribute}"));
            }
        }
    }
    assert!(cases >= 1800, "MuJoCo 4.0.0 has 1894 attributes: {cases}");
    assert!(silent.is_empty(), "{} of {cases}: {silent:?}", silent.len());
}

/// What no schema has yet: an attribute of each element that is read, and an element in each place.
#[test]
fn what_a_later_format_adds_is_told() {
    let elements = [
        "mujoco",
        "compiler",
        "option",
        "option/flag",
        "body",
        "body/inertial",
        "body/joint",
        "body/freejoint",
        "body/geom",
        "default/joint",
    ];
    for path in elements {
        assert_eq!(fate(path, "added_tomorrow", "1"), Fate::Told, "{path}");
    }
    for path in ["gadget", "compiler/gadget", "option/gadget", "body/gadget"] {
        assert_eq!(fate(path, "size", "1"), Fate::Told, "{path}");
    }
}

/// What is read in one place or with one number only is told elsewhere.
#[test]
fn values_that_are_read_in_part_are_told() {
    let notes = |joint: &str| {
        let inertial = r#"<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>"#;
        let text = format!("<mujoco><worldbody><body><joint name='j' {joint}/>{inertial}</body></worldbody></mujoco>");
        let (_, notes) = mjcf::import(&text, "f.xml").unwrap_or_else(|error| panic!("{error}"));
        notes.into_iter().map(|note| note.text).collect::<Vec<_>>()
    };
    let cases = [
        ("damping='1'", None),
        ("damping='1 0'", None),
        ("damping='1 2'", Some("the damping after its first number of joint 'j' is left out")),
        ("type='ball' range='0 1'", Some("the limit of joint 'j' is left out")),
        ("type='ball' range='0 1' limited='false'", None),
        ("actuatorfrcrange='-1 1'", None),
        ("actuatorfrcrange='-1 2'", Some("the bound of the actuators' force of joint 'j' is left out")),
        ("type='ball' actuatorfrcrange='-1 1'", Some("the bound of the actuators' force of joint 'j' is left out")),
        ("type='free' armature='1'", Some("the armature of joint 'j' is left out")),
        ("type='free' damping='1'", Some("the damping of joint 'j' is left out")),
        ("type='free' stiffness='1'", Some("the stiffness of joint 'j' is left out")),
        ("springdamper='1 1'", Some("of <joint> is left out: springdamper")),
    ];
    for (joint, due) in cases {
        assert_eq!(notes(joint), Vec::from_iter(due), "{joint}");
    }
}
