//! Evaluates typed numbers and expressions: `12.5`, `360/7`, `2*(3+4)`, `sqrt(2)`.
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = factor { ("*" | "/") factor }
//! factor  = ["-" | "+"] factor | number | "pi" | "sqrt" "(" sum ")" | "(" sum ")"
//! ```

/// The maximum nesting of brackets and signs; deeper expressions are rejected, as the parser
/// recurses.
const DEEPEST: usize = 50;

/// Evaluates an expression; `None` if it is malformed or its value is not finite.
pub(crate) fn value(text: &str) -> Option<f64> {
    // egui's own fields use the Unicode minus sign.
    let plain = text.replace('\u{2212}', "-");
    let letters: Vec<char> = plain.chars().filter(|c| !c.is_whitespace()).collect();
    let mut reader = Reader { rest: &letters, depth: 0 };
    let value = reader.sum()?;
    (reader.rest.is_empty() && value.is_finite()).then_some(value)
}

struct Reader<'a> {
    rest: &'a [char],
    depth: usize,
}

impl Reader<'_> {
    fn sum(&mut self) -> Option<f64> {
        let mut sum = self.product()?;
        loop {
            if self.takes("+") {
                sum += self.product()?;
            } else if self.takes("-") {
                sum -= self.product()?;
            } else {
                return Some(sum);
            }
        }
    }

    fn product(&mut self) -> Option<f64> {
        let mut product = self.factor()?;
        loop {
            if self.takes("*") {
                product *= self.factor()?;
            } else if self.takes("/") {
                product /= self.factor()?;
            } else {
                return Some(product);
            }
        }
    }

    fn factor(&mut self) -> Option<f64> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return None;
        }
        let value = if self.takes("-") {
            self.factor().map(|value| -value)
        } else if self.takes("+") {
            self.factor()
        } else if self.takes("pi") {
            Some(std::f64::consts::PI)
        } else if self.takes("sqrt(") {
            self.closed().map(libm::sqrt)
        } else if self.takes("(") {
            self.closed()
        } else {
            self.number()
        };
        self.depth -= 1;
        value
    }

    /// Parses a sum up to the closing bracket.
    fn closed(&mut self) -> Option<f64> {
        let sum = self.sum()?;
        self.takes(")").then_some(sum)
    }

    fn number(&mut self) -> Option<f64> {
        let mut length = 0;
        while let Some(letter) = self.rest.get(length) {
            // A sign belongs to the number only directly after an exponent's e.
            let exponent = matches!(letter, 'e' | 'E') && length > 0;
            let sign = matches!(letter, '+' | '-')
                && length > 0
                && matches!(self.rest[length - 1], 'e' | 'E');
            if !(letter.is_ascii_digit() || *letter == '.' || exponent || sign) {
                break;
            }
            length += 1;
        }
        let (number, rest) = self.rest.split_at(length);
        self.rest = rest;
        number.iter().collect::<String>().parse().ok()
    }

    fn takes(&mut self, wanted: &str) -> bool {
        let mut rest = self.rest;
        for letter in wanted.chars() {
            match rest.split_first() {
                Some((first, tail)) if first.to_ascii_lowercase() == letter => rest = tail,
                _ => return false,
            }
        }
        self.rest = rest;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_bind_closer_than_sums_and_brackets_closest() {
        for (text, expected) in [
            ("12.5", 12.5),
            (" 1 000 ", 1000.0),
            ("-3", -3.0),
            ("\u{2212}3", -3.0),
            ("1+2*3", 7.0),
            ("(1+2)*3", 9.0),
            ("10-4-3", 3.0),
            ("360/7", 360.0 / 7.0),
            ("2*-3", -6.0),
            ("1e3+1E-1", 1000.1),
            ("2*PI", std::f64::consts::TAU),
            ("sqrt(9)/2", 1.5),
            (".5", 0.5),
        ] {
            assert_eq!(value(text), Some(expected), "{text}");
        }
    }

    #[test]
    fn invalid_expressions_and_infinite_results_have_no_value() {
        for text in ["", "abc", "1+", "(1", "1)", "1/0", "nan", "inf", "1e999", "1..2", "sqrt(-1)"]
        {
            assert_eq!(value(text), None, "{text}");
        }
        assert_eq!(value(&"(".repeat(100_000)), None);
        assert_eq!(value(&"-".repeat(100_001)), None);
    }
}
