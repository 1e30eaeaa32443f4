//! What holds for the whole file: the compiler's settings, gravity and the defaults of classes.

use super::element::Element;
use super::error::{At, MjcfProblem};
use roxmltree::Node;
use std::collections::HashMap;

/// The class that everything has.
const MAIN: &str = "main";
/// Gravity where a file does not say it, m/s².
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// The attributes of a class by element and name.
#[derive(Clone, Debug, Default)]
pub(super) struct Class<'d>(HashMap<(&'d str, &'d str), &'d str>);

impl<'d> Class<'d> {
    /// An attribute of an element.
    pub fn get(&self, element: &str, attribute: &str) -> Option<&'d str> {
        self.0.get(&(element, attribute)).copied()
    }
}

/// What holds for the whole file.
pub(super) struct Settings<'d> {
    /// Gravity, m/s².
    pub gravity: [f64; 3],
    /// The letters of Euler angles.
    pub sequence: [u8; 3],
    /// Whether a range limits a joint that does not say so.
    pub autolimits: bool,
    /// Whether shapes give inertia to bodies that have an inertial too.
    pub from_shapes: bool,
    radians: bool,
    classes: HashMap<&'d str, Class<'d>>,
}

impl<'d> Settings<'d> {
    /// Reads them.
    pub fn read(root: Node<'d, 'd>) -> Result<Self, At> {
        let mut settings = Self {
            gravity: GRAVITY,
            sequence: *b"xyz",
            autolimits: true,
            from_shapes: false,
            radians: false,
            classes: HashMap::from([(MAIN, Class::default())]),
        };
        let children = || root.children().filter(Node::is_element);
        for node in children().filter(|node| node.has_tag_name("compiler")) {
            settings.compiler(Element { node, owner: "the compiler", class: None })?;
        }
        let mut weightless = false;
        for node in children().filter(|node| node.has_tag_name("option")) {
            let option = Element { node, owner: "the option", class: None };
            settings.gravity = option.numbers("gravity")?.unwrap_or(settings.gravity);
            for node in node.children().filter(|node| node.has_tag_name("flag")) {
                let words = [("enable", false), ("disable", true)];
                let flag = Element { node, owner: "the flag", class: None };
                weightless = flag.word("gravity", &words, "enable, disable")?.unwrap_or(weightless);
            }
        }
        if weightless {
            settings.gravity = [0.0; 3];
        }
        for node in children().filter(|node| node.has_tag_name("default")) {
            settings.defaults(node)?;
        }
        Ok(settings)
    }

    fn compiler(&mut self, compiler: Element<'_, 'd>) -> Result<(), At> {
        self.radians = compiler.word("angle", &[("radian", true), ("degree", false)], "radian, degree")?.unwrap_or(self.radians);
        self.autolimits = compiler.flag("autolimits")?.unwrap_or(self.autolimits);
        if let Some(text) = compiler.attribute("eulerseq") {
            let letters = <[u8; 3]>::try_from(text.as_bytes()).ok().filter(|letters| letters.iter().all(|x| b"xyzXYZ".contains(x)));
            let (attribute, value) = ("eulerseq".to_owned(), text.to_owned());
            let owner = compiler.owner.to_owned();
            let unknown = || compiler.problem(MjcfProblem::UnknownWord { owner, attribute, value, expected: "three letters of xyzXYZ" });
            self.sequence = letters.ok_or_else(unknown)?;
        }
        let refused = |what: &str| Err(compiler.problem(MjcfProblem::NotRead { what: format!("the compiler's {what}") }));
        // These edit masses, or the frames that coordinates are in.
        for name in ["balanceinertia", "alignfree"] {
            if compiler.flag(name)? == Some(true) {
                return refused(&format!("{name}=\"true\""));
            }
        }
        for name in ["boundmass", "boundinertia", "settotalmass"] {
            if compiler.number(name)?.is_some_and(|x| x > 0.0) {
                return refused(name);
            }
        }
        if compiler.attribute("coordinate").is_some_and(|word| word != "local") {
            return refused("coordinate");
        }
        if compiler.numbers::<2>("inertiagrouprange")?.is_some_and(|range| range != [0.0, 5.0]) {
            return refused("inertiagrouprange");
        }
        self.from_shapes = compiler.flag_or_auto("inertiafromgeom")?.unwrap_or(self.from_shapes);
        Ok(())
    }

    /// The classes of a `<default>`, each with the attributes of those around it.
    fn defaults(&mut self, outermost: Node<'d, 'd>) -> Result<(), At> {
        let mut open = vec![(outermost, Class::default())];
        while let Some((node, mut class)) = open.pop() {
            let name = match node.attribute("class") {
                Some(name) => name,
                None if node == outermost => MAIN,
                None => {
                    let (element, owner) = ("default".to_owned(), "a class".to_owned());
                    return Err(MjcfProblem::MissingAttribute { element, owner, attribute: "class" }.at(node.range().start));
                }
            };
            if name == MAIN
                && let Some(known) = self.classes.get(MAIN)
            {
                class = known.clone();
            }
            for element in node.children().filter(|child| child.is_element() && !child.has_tag_name("default")) {
                let tag = element.tag_name().name();
                class.0.extend(element.attributes().map(|attribute| ((tag, attribute.name()), attribute.value())));
            }
            open.extend(node.children().filter(|child| child.has_tag_name("default")).map(|child| (child, class.clone())));
            if node == outermost {
                // The outermost class is that of everything, by whatever name.
                self.classes.insert(MAIN, class.clone());
            }
            self.classes.insert(name, class);
        }
        Ok(())
    }

    /// An angle of the file, rad.
    pub fn angle(&self, x: f64) -> f64 {
        if self.radians { x } else { x.to_radians() }
    }

    /// The class of an element: its own, or else that of the bodies around it, or else that of everything.
    pub fn class(&self, node: Node<'d, 'd>, owner: &str, around: Option<&'d str>) -> Result<Option<&Class<'d>>, At> {
        let name = node.attribute("class").or(around).unwrap_or(MAIN);
        let unknown = || MjcfProblem::UnknownClass { owner: owner.to_owned(), class: name.to_owned() }.at(node.range().start);
        self.classes.get(name).map(Some).ok_or_else(unknown)
    }
}
