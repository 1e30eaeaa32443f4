//! A report on disk, and access to it for tests.

use std::fs;

use featherbench_report::Section;
use featherbench_results::{Row, RunInfo};
use tempfile::TempDir;

/// A report in a folder of its own.
pub struct Written {
    /// The folder.
    pub folder: TempDir,
    /// The page.
    pub index: String,
}

impl Written {
    /// Writes a report.
    pub fn of(run: &RunInfo, rows: &[Row], sections: &[Section]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let paths = featherbench_report::write(run, rows, sections, folder.path()).unwrap();
        assert_eq!(paths.index, folder.path().join("index.html"));
        assert!(paths.files.iter().all(|path| path.is_file()));
        let index = fs::read_to_string(paths.index).unwrap();
        Self { folder, index }
    }

    /// A file of the report.
    pub fn text(&self, name: &str) -> String {
        fs::read_to_string(self.folder.path().join(name)).unwrap()
    }

    /// A data script's JSON, without the call around it.
    pub fn data(&self, name: &str) -> serde_json::Value {
        let text = self.text(&format!("data/{name}.js"));
        let json = text.strip_prefix(&format!("featherbench.chunk(\"{name}\",")).and_then(|rest| rest.strip_suffix(");\n"));
        serde_json::from_str(json.unwrap_or_else(|| panic!("data/{name}.js is not one call"))).unwrap()
    }

    /// The names of the data scripts.
    pub fn chunk_names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path().join("data")).unwrap();
        entries.map(|entry| entry.unwrap().path().file_stem().unwrap().to_str().unwrap().to_owned()).collect()
    }

    /// A section's text, or that of a part: on its own page if it has one, else on the first.
    pub fn section(&self, id: &str) -> String {
        let own = fs::read_to_string(self.folder.path().join(format!("sections/{id}.html")));
        let (page, opening) = match &own {
            Ok(page) => (page, "<section".to_owned()),
            Err(_) => (&self.index, format!("<section id=\"{id}\"")),
        };
        let start = page.find(&opening).unwrap_or_else(|| panic!("no section {id}"));
        page[start..start + page[start..].find("</section>").unwrap()].to_owned()
    }
}
