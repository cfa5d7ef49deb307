//! The words of an SVG path (moves, lines, arcs) as steps with absolute coordinates.

/// One step, with arcs as cubic curves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step<Number> {
    Move([Number; 2]),
    Line([Number; 2]),
    /// Two control points and the end.
    Curve([Number; 6]),
    Close,
}

impl<Number> Step<Number> {
    pub fn map<Other>(self, to: impl Fn(Number) -> Other) -> Step<Other> {
        match self {
            Step::Move(point) => Step::Move(point.map(to)),
            Step::Line(point) => Step::Line(point.map(to)),
            Step::Curve(points) => Step::Curve(points.map(to)),
            Step::Close => Step::Close,
        }
    }
}

/// The steps of a path of M, L, H, V, A and Z, in capitals or relative; it ends where anything else stands.
pub fn steps(words: &str) -> Vec<Step<f64>> {
    let mut reader = Reader { at: [0.0; 2], begun: [0.0; 2], found: Vec::new() };
    let is_command = |letter: char| letter.is_ascii_alphabetic() && letter != 'e';
    let starts: Vec<usize> = words.match_indices(is_command).map(|(at, _)| at).collect();
    for (index, &start) in starts.iter().enumerate() {
        let end = starts.get(index + 1).copied().unwrap_or(words.len());
        let separators = |letter: char| letter == ',' || letter.is_whitespace();
        let numbers = words[start + 1..end].split(separators).filter(|word| !word.is_empty());
        let Ok(numbers) = numbers.map(str::parse).collect::<Result<Vec<f64>, _>>() else { break };
        if reader.command(&words[start..=start], &numbers).is_none() {
            break;
        }
    }
    reader.found
}

struct Reader {
    at: [f64; 2],
    begun: [f64; 2],
    found: Vec<Step<f64>>,
}

impl Reader {
    /// Nothing where the command is unknown.
    fn command(&mut self, command: &str, numbers: &[f64]) -> Option<()> {
        let [x, y] = self.at;
        let base = if command == command.to_uppercase() { [0.0; 2] } else { self.at };
        match command.to_uppercase().as_str() {
            "M" => {
                let (pairs, _) = numbers.as_chunks::<2>();
                let (first, rest) = pairs.split_first()?;
                self.at = [base[0] + first[0], base[1] + first[1]];
                self.begun = self.at;
                self.found.push(Step::Move(self.at));
                rest.iter().for_each(|pair| self.line([base[0] + pair[0], base[1] + pair[1]]));
            }
            "L" => numbers.as_chunks::<2>().0.iter().for_each(|pair| {
                self.line([base[0] + pair[0], base[1] + pair[1]]);
            }),
            "H" => self.line([base[0] + numbers.first()?, y]),
            "V" => self.line([x, base[1] + numbers.first()?]),
            "A" => {
                let [radius, _, _, large, sweep, to_x, to_y] = *numbers.first_chunk::<7>()?;
                let to = [base[0] + to_x, base[1] + to_y];
                self.arc(radius, [large, sweep].map(|flag| flag != 0.0), to);
            }
            "Z" => {
                self.at = self.begun;
                self.found.push(Step::Close);
            }
            _ => return None,
        }
        Some(())
    }

    fn line(&mut self, to: [f64; 2]) {
        self.at = to;
        self.found.push(Step::Line(to));
    }

    /// An arc of a circle (SVG 2, appendix B.2.4) as curves of a quarter at most.
    fn arc(&mut self, radius: f64, [large, sweep]: [bool; 2], to: [f64; 2]) {
        let from = self.at;
        let half = [(to[0] - from[0]) / 2.0, (to[1] - from[1]) / 2.0];
        let reach = half[0].hypot(half[1]);
        if reach == 0.0 {
            return;
        }
        let radius = radius.max(reach);
        let rise = (radius * radius - reach * reach).max(0.0).sqrt() / reach;
        let rise = if large == sweep { -rise } else { rise };
        let centre = [from[0] + half[0] - rise * half[1], from[1] + half[1] + rise * half[0]];
        let angle = |point: [f64; 2]| f64::atan2(point[1] - centre[1], point[0] - centre[0]);
        let (first, last) = (angle(from), angle(to));
        let turn = match sweep {
            true => (last - first).rem_euclid(std::f64::consts::TAU),
            false => -(first - last).rem_euclid(std::f64::consts::TAU),
        };
        let pieces = (turn.abs() / std::f64::consts::FRAC_PI_2).ceil().max(1.0);
        let step = turn / pieces;
        let pull = 4.0 / 3.0 * (step / 4.0).tan() * radius;
        for piece in 0..pieces as u32 {
            let [a, b] =
                [f64::from(piece), f64::from(piece + 1)].map(|at| (first + step * at).sin_cos());
            let on = |(sin, cos): (f64, f64)| [centre[0] + radius * cos, centre[1] + radius * sin];
            let ([ax, ay], [bx, by]) = (on(a), on(b));
            let curve =
                [ax - pull * a.0, ay + pull * a.1, bx + pull * b.0, by - pull * b.1, bx, by];
            self.found.push(Step::Curve(curve));
        }
        self.at = to;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_absolute_and_a_closed_path_goes_back_to_where_it_began() {
        let found = steps("M1 2h9v8L4 4Zl1 1");
        let expected = [
            Step::Move([1.0, 2.0]),
            Step::Line([10.0, 2.0]),
            Step::Line([10.0, 10.0]),
            Step::Line([4.0, 4.0]),
            Step::Close,
            Step::Line([2.0, 3.0]),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn two_half_circles_stay_on_their_circle() {
        let found = steps("M-2 0a2 2 0 1 1 4 0a2 2 0 1 1 -4 0Z");
        assert_eq!(found.len(), 6, "{found:?}");
        for step in &found {
            if let Step::Curve([.., x, y]) = step {
                assert!((x.hypot(*y) - 2.0).abs() < 1e-12, "{step:?}");
            }
        }
        // With the sweep of 1, y grows downwards: the first half runs through the top.
        assert!(
            matches!(found[1], Step::Curve([.., x, y]) if x.abs() < 1e-12 && (y + 2.0).abs() < 1e-12)
        );
        assert!(steps("M0 0 L1 1 T3 3").len() == 2);
    }
}
