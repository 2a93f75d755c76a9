//! The figures of a case: the result of a naive program, ours, and the bound for ours.
//!
//! Each figure is printed as one line and, if `MARRAZTU_FIGURES` names a folder, written to a file
//! there. `tools/stability.sh` makes its page from these files.

use super::cases::CASES;

/// A figure of a case.
pub(crate) struct Figure {
    /// The case's number.
    pub(crate) case: u8,
    /// The measured quantity.
    pub(crate) what: &'static str,
    /// A method used by other programs, with its result. The result has to exceed the bound,
    /// because a case that the naive method passes is not hard.
    pub(crate) naive: Option<(&'static str, f64)>,
    /// Our result.
    pub(crate) ours: f64,
    /// The largest result that passes.
    pub(crate) bound: f64,
    /// The unit of all three numbers.
    pub(crate) unit: &'static str,
}

impl Figure {
    /// Records the figure, and checks it against its bound.
    #[track_caller]
    pub(crate) fn hold(self) {
        let Self { case, what, naive, ours, bound, unit } = self;
        let row = CASES.iter().find(|row| row.number == case).expect("the case has a row");
        let (how, wrong) = naive.map_or(("", String::new()), |(how, x)| (how, short(x)));
        let line = [
            &format!("{case:02}"),
            row.group,
            row.oracle,
            row.wrong,
            what,
            how,
            &wrong,
            &short(ours),
            &short(bound),
            unit,
        ]
        .join("\t");
        println!("figure\t{line}");
        if let Some(folder) = std::env::var_os("MARRAZTU_FIGURES") {
            let name: String =
                what.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
            let path = std::path::Path::new(&folder).join(format!("{case:02}-{name}.tsv"));
            std::fs::write(path, line + "\n").expect("figures can be written");
        }
        assert!(
            ours <= bound,
            "case {case}, {what}: {ours} {unit}, and at most {bound} is promised"
        );
        if let Some((how, wrong)) = naive {
            let worse = wrong.is_nan() || wrong > bound;
            assert!(worse, "case {case}, {what}: {how} gives {wrong} {unit}, so it is not hard");
        }
    }
}

/// Formats a number in a few characters.
fn short(x: f64) -> String {
    if x == 0.0 || (1e-3..1e6).contains(&x.abs()) {
        let text = format!("{x:.4}");
        let text = text.trim_end_matches('0').trim_end_matches('.').to_owned();
        // Large numbers need no decimals.
        if x.abs() >= 1000.0 { format!("{x:.0}") } else { text }
    } else {
        format!("{x:.1e}")
    }
}
