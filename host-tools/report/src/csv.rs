//! The numbers of a figure as a link that is its own file: a page that is sent on by mail takes them along, and no
//! script is needed to save them. A `data:` address (RFC 2397) of comma-separated values whose headings name the units.

use super::thin::Point;

/// A file in a link.
pub struct Csv {
    /// What the file is called.
    pub file: String,
    /// The link's address: letters, digits and what neither HTML nor an address takes for anything else.
    pub address: String,
    /// Of a whole log that can be zoomed into: so many rows, of so many.
    pub rows: Option<(usize, usize)>,
}

impl Csv {
    /// A file of so many columns, each with its name and its unit: `time_s`.
    pub fn new(name: &str, columns: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> Self {
        let letters = |c: char| if c.is_alphanumeric() || "._".contains(c) { c } else { '-' };
        let mut address = format!("data:text/csv,{}", columns.join(","));
        for row in rows {
            address += LINE;
            address += &row.join(",").replace(' ', SPACE);
        }
        let file = format!("{}.csv", name.chars().map(letters).collect::<String>());
        Self { file, address: address + LINE, rows: None }
    }

    /// Curves one after the other, the first column saying which a row is of; `headings` are of what they run over and
    /// of their value.
    pub fn of_curves(name: &str, headings: [&str; 2], curves: &[(&str, &[Point])]) -> Self {
        let row = |curve: &str, (x, y): Point| vec![curve.to_owned(), digits(x), digits(y)];
        let rows = curves.iter().flat_map(|(curve, points)| points.iter().map(|&point| row(curve, point)));
        Self::new(name, &["curve", headings[0], headings[1]], rows)
    }
}

/// The end of a line: an address loses a real one.
const LINE: &str = "%0A";
/// A space, which an address has none of.
const SPACE: &str = "%20";

/// A number with so many decimals, and none of them in vain; empty where it is none.
pub fn decimals(x: f64, decimals: usize) -> String {
    let text = if x.is_finite() && x.abs() < MOST { format!("{x:.decimals$}") } else { String::new() };
    let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

/// A number with five digits or more; empty where it is none.
pub fn digits(x: f64) -> String {
    let magnitude = if x == 0.0 { 0.0 } else { x.abs().log10().floor() };
    // No more than an f64 has below 1.
    decimals(x, (4.0 - magnitude).clamp(0.0, 17.0) as usize)
}

/// Nothing that is larger is a measurement.
const MOST: f64 = 1e12;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_what_is_none_is_empty() {
        let of = [1.0, -0.0, 0.100_000_01, 12_345.678, -1e-7, f64::NAN, f64::INFINITY, 1e300].map(digits);
        assert_eq!(of, ["1", "0", "0.1", "12346", "-0.0000001", "", "", ""]);
        assert_eq!([decimals(20.000_5, 4), decimals(-0.000_04, 4), decimals(100.0, 0)], ["20.0005", "0", "100"]);
    }

    #[test]
    fn an_address_has_no_letter_of_another_meaning() {
        let csv = Csv::new("a\"log>b.csv held out", &["time_s", "voltage_v"], [vec!["0".to_owned(), digits(-1.5)]]);
        assert_eq!(csv.file, "a-log-b.csv-held-out.csv");
        assert_eq!(csv.address, "data:text/csv,time_s,voltage_v%0A0,-1.5%0A");
        let curves: [(&str, &[Point]); 2] = [("training", &[(1.0, 0.2)]), ("held out", &[(2.0, -0.3)])];
        let csv = Csv::of_curves("convergence", ["step", "error_um"], &curves);
        assert_eq!(csv.address, "data:text/csv,curve,step,error_um%0Atraining,1,0.2%0Aheld%20out,2,-0.3%0A");
    }
}
