//! The page of what was reproduced of the thesis: one HTML file that needs nothing else, for a screen, a phone or
//! paper.

use super::error::ReportError;
use super::section::Section;
use askama::Template;

/// What the page says.
#[derive(Clone, Copy, Debug)]
pub struct ReproductionReport<'a> {
    /// What was reproduced, in the order of the page.
    pub sections: &'a [&'a Section],
    /// Whose figures these are, in a sentence.
    pub whose: &'a str,
    /// Logs, preparation, search.
    pub facts: &'a [(String, String)],
}

/// The page as HTML.
///
/// # Errors
/// [`ReportError::Template`] where the template cannot be rendered.
pub fn reproduction(report: &ReproductionReport<'_>) -> Result<String, ReportError> {
    let ReproductionReport { sections, whose, facts } = *report;
    Ok(Page { sections, whose, facts }.render()?)
}

/// The page that the template fills.
#[derive(Template)]
#[template(path = "reproduce.html")]
struct Page<'a> {
    sections: &'a [&'a Section],
    whose: &'a str,
    facts: &'a [(String, String)],
}

#[cfg(test)]
mod tests {
    use super::super::section::{Grid, Picture};
    use super::*;

    #[test]
    fn tables_figures_and_notes_are_there_and_names_are_escaped() {
        let mut grid = Grid::new("Caption. Thesis: its own actuator.".to_owned()).words("log", 3).numbers("µm", 3);
        grid.row(["<b>".to_owned(), "0.5".to_owned()]);
        let figure = Picture {
            svg: "<svg></svg>".to_owned(),
            name: "F & G".to_owned(),
            role: "held out",
            caption: "c".to_owned(),
        };
        let section = Section {
            title: "Title",
            tables: vec![grid],
            notes: vec!["A note.".to_owned()],
            figures: vec![figure],
            json: String::new(),
        };
        let facts = [("Tool".to_owned(), "piezo".to_owned())];
        let page = reproduction(&ReproductionReport { sections: &[&section], whose: "Ours.", facts: &facts }).unwrap();
        for words in [
            "<h2>Title</h2>",
            "Caption. Thesis",
            "&#60;b&#62;",
            r#"<th scope="col">µm</th>"#,
            "<td>0.5</td>",
            "<svg></svg>",
            "F &#38; G",
            "A note.",
        ] {
            assert!(page.contains(words), "{words} is missing");
        }
        assert!(!page.contains("http") && !page.contains("<script"));
    }
}
