//! Plots as SVG: panels with axes, lines, bars and words. What colour a class has is the style sheet's business
//! (`templates/figure.css`); no coordinate is ever other than finite.

use super::axis::Axis;
use super::thin::Point;
use askama::filters::{Escaper, Html};

/// Style of all figures.
const STYLE: &str = include_str!("../templates/figure.css");
/// Width of a letter, as a fraction of the font size.
const LETTER: f64 = 0.55;
/// Least width of what marks a stretch.
const LEAST_WIDTH: f64 = 1.0;

/// A drawing under way.
pub struct Drawing {
    width: f64,
    height: f64,
    font: f64,
    body: String,
}

/// Where a panel's data go, in units of the drawing.
#[derive(Clone, Copy)]
pub struct Frame {
    /// Left edge in the picture.
    pub left: f64,
    /// Upper edge in the picture.
    pub top: f64,
    /// Width in the picture.
    pub width: f64,
    /// Height in the picture.
    pub height: f64,
}

/// A frame with its axes.
pub struct Panel {
    frame: Frame,
    x: Axis,
    y: Axis,
}

impl Panel {
    fn at(&self, (x, y): Point) -> Point {
        let Frame { left, top, width, height } = self.frame;
        (left + width * self.x.position(x), top + height * (1.0 - self.y.position(y)))
    }
}

impl Drawing {
    /// An empty drawing of a size and a font size, in its own units.
    pub fn new(width: f64, height: f64, font: f64) -> Self {
        Self { width, height, font, body: String::new() }
    }

    /// A panel: grid, tick labels, the vertical axis's title above it and the horizontal one's below, where it has one.
    pub fn panel(&mut self, frame: Frame, x: Axis, y: Axis, (x_title, y_title): (&str, &str)) -> Panel {
        let Frame { left, top, width, height } = frame;
        let (right, bottom, font) = (left + width, top + height, self.font);
        for (at, label) in &y.ticks {
            let y = bottom - at * height;
            self.body += &format!(r#"<path class="grid" d="M{left:.1} {y:.1}H{right:.1}"/>"#);
            self.text((left - 0.5 * font, y + 0.35 * font), "end", label);
        }
        for (at, label) in &x.ticks {
            let x = left + at * width;
            self.body += &format!(r#"<path class="grid" d="M{x:.1} {top:.1}V{bottom:.1}"/>"#);
            if !x_title.is_empty() {
                self.text((x, bottom + 1.25 * font), "middle", label);
            }
        }
        self.body += &format!(r#"<path class="edge" d="M{left:.1} {top:.1}V{bottom:.1}H{right:.1}"/>"#);
        self.text((left - 3.2 * font, top - 0.7 * font), "start", y_title);
        self.text((left + width / 2.0, bottom + 2.55 * font), "middle", x_title);
        Panel { frame, x, y }
    }

    /// A line through points.
    pub fn line(&mut self, panel: &Panel, class: &str, points: &[Point]) {
        let drawable = points.iter().filter(|(x, y)| panel.x.contains(*x) && panel.y.contains(*y));
        let text: Vec<String> = drawable.map(|&point| panel.at(point)).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        self.body += &format!(r#"<polyline class="{class}" points="{}"/>"#, text.join(" "));
    }

    /// The line y = 0, where the panel has it.
    pub fn zero(&mut self, panel: &Panel) {
        if panel.y.contains(0.0) {
            let (left, y) = (panel.frame.left, panel.at((0.0, 0.0)).1);
            self.body += &format!(r#"<path class="zero" d="M{left:.1} {y:.1}h{:.1}"/>"#, panel.frame.width);
        }
    }

    /// A rectangle between two corners in the panel's data.
    pub fn bar(&mut self, panel: &Panel, class: &str, from: Point, to: Point) {
        let (a, b) = (panel.at(from), panel.at(to));
        let (x, y, width, height) = (a.0.min(b.0), a.1.min(b.1), (b.0 - a.0).abs(), (b.1 - a.1).abs());
        if width.is_finite() && height.is_finite() {
            self.body +=
                &format!(r#"<rect class="{class}" x="{x:.1}" y="{y:.1}" width="{width:.1}" height="{height:.1}"/>"#);
        }
    }

    /// An area between two lines over the same stretch.
    pub fn band(&mut self, panel: &Panel, class: &str, upper: &[Point], lower: &[Point]) {
        let around =
            upper.iter().chain(lower.iter().rev()).filter(|(x, y)| panel.x.contains(*x) && panel.y.contains(*y));
        let text: Vec<String> = around.map(|&point| panel.at(point)).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        self.body += &format!(r#"<polygon class="{class}" points="{}"/>"#, text.join(" "));
    }

    /// A circle around a point.
    pub fn circle(&mut self, panel: &Panel, class: &str, point: Point) {
        if panel.x.contains(point.0) && panel.y.contains(point.1) {
            let ((x, y), r) = (panel.at(point), 0.45 * self.font);
            self.body += &format!(r#"<circle class="{class}" fill="none" cx="{x:.1}" cy="{y:.1}" r="{r:.1}"/>"#);
        }
    }

    /// Marks what a panel has of a stretch of the horizontal axis, however short.
    pub fn window(&mut self, panel: &Panel, class: &str, from: f64, to: f64) {
        let Frame { left, top, width, height } = panel.frame;
        let (from, to) = (panel.at((from, 0.0)).0.max(left), panel.at((to, 0.0)).0.min(left + width));
        if from <= to {
            let width = (to - from).max(LEAST_WIDTH);
            self.body += &format!(
                r#"<rect class="{class}" x="{from:.1}" y="{top:.1}" width="{width:.1}" height="{height:.1}"/>"#
            );
        }
    }

    /// What the lines are: a sample and a word for each class, right-aligned above a panel.
    pub fn legend(&mut self, panel: &Panel, entries: &[(&str, &str)]) {
        let font = self.font;
        let (mut right, y) = (panel.frame.left + panel.frame.width, panel.frame.top - 0.7 * font);
        for (class, word) in entries.iter().rev() {
            self.text((right, y), "end", word);
            right -= (word.chars().count() as f64 * LETTER + 0.4) * font;
            let (start, y) = (right - 1.5 * font, y - 0.33 * font);
            self.body += &format!(r#"<path class="{class}" d="M{start:.1} {y:.1}H{right:.1}"/>"#);
            right = start - 0.9 * font;
        }
    }

    /// Writes words at a point.
    pub fn text(&mut self, (x, y): Point, anchor: &str, words: &str) {
        if !words.is_empty() {
            self.body += &format!(r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}">{}</text>"#, escaped(words));
        }
    }

    /// A heading, larger than other words.
    pub fn heading(&mut self, (x, y): Point, words: &str) {
        let (size, words) = (1.25 * self.font, escaped(words));
        self.body += &format!(r#"<text class="heading" x="{x:.1}" y="{y:.1}" font-size="{size:.1}">{words}</text>"#);
    }

    /// The drawing for a page that has the style, as wide as the page makes it.
    pub fn inline(&self, label: &str) -> String {
        let Self { width, height, font, body } = self;
        let label = escaped(label);
        format!(
            r#"<svg class="figure" role="img" aria-label="{label}" viewBox="0 0 {width} {height}" font-size="{font}">{body}</svg>"#
        )
    }

    /// The drawing as a file of its own.
    pub fn standalone(&self, label: &str) -> String {
        let Self { width, height, font, body } = self;
        let label = escaped(label);
        format!(
            concat!(
                r#"<svg xmlns="http://www.w3.org/2000/svg" class="figure" role="img" aria-label="{label}" "#,
                r#"viewBox="0 0 {width} {height}" width="{width}" height="{height}" font-size="{font}">"#,
                r#"<style>{style}</style><rect width="100%" height="100%" fill="white"/>{body}</svg>"#,
                "\n"
            ),
            label = label,
            width = width,
            height = height,
            font = font,
            style = STYLE,
            body = body,
        )
    }
}

/// Text that neither HTML nor XML takes for markup, without the control characters that XML forbids.
fn escaped(text: &str) -> String {
    let printable: String = text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    let mut escaped = String::new();
    Html.write_escaped_str(&mut escaped, &printable).expect("a String takes all that is written to it");
    escaped
}
