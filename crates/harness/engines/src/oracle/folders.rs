//! Messages of engines without the folders of this machine: rows are alike on all machines, and a reader knows the file by its name.

/// What stands before a path in a message.
const BEFORE: &[char] = &[' ', '\t', '\n', '\'', '"', '`', '(', '[', '{', '<', '=', ','];
/// What ends one. A colon is between a file and a line.
const BEHIND: &[char] = &[' ', '\t', '\n', '\'', '"', '`', ')', ']', '}', '>', ',', ';', ':'];

/// The text with the last part of each absolute path in its place. A folder with a space in its name ends the path there.
pub(crate) fn without_folders(text: &str) -> String {
    let mut short = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find('/') {
        let (before, path) = rest.split_at(at);
        let (path, behind) = path.split_at(path.find(BEHIND).unwrap_or(path.len()));
        short += before;
        let starts = short.chars().next_back().is_none_or(|last| BEFORE.contains(&last));
        let folders = path.trim_end_matches('/').rsplit_once('/').filter(|(folders, _)| starts && folders.len() > 1);
        short += folders.map_or(path, |(_, name)| name);
        rest = behind;
    }
    short + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_become_names() {
        for (text, due) in [
            ("", ""),
            ("RuntimeError: /a/b/c.urdf:12: error: no 'x'", "RuntimeError: c.urdf:12: error: no 'x'"),
            ("/a/b.py:1: UserWarning (/a/c d) '/a/b/' \"/a/b\"", "b.py:1: UserWarning (c d) 'b' \"b\""),
            ("file=/a/b/é.xml, /a/b", "file=é.xml, b"),
            ("See https://a.b/c/d.html, M / m, m/s², a/b/c, /tmp and 1//2", "See https://a.b/c/d.html, M / m, m/s², a/b/c, /tmp and 1//2"),
            ("package://a/b.stl file:///a/b.stl", "package://a/b.stl file:///a/b.stl"),
            ("/", "/"),
            ("//a", "//a"),
        ] {
            assert_eq!(without_folders(text), due, "{text}");
            assert_eq!(without_folders(due), due, "a second time changes nothing");
        }
    }
}
