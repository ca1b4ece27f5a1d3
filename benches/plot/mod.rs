//! Pictures as SVG: lines and points over two axes, shared by the benchmarks that draw.

use std::fmt::Write;

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 440.0;
const LEFT: f64 = 80.0;
const RIGHT: f64 = 20.0;
const TOP: f64 = 50.0;
const BOTTOM: f64 = 60.0;
/// Decades from which on a logarithmic ordinate names powers of ten alone.
const LONG: f64 = 4.0;

pub const GREY: &str = "#999999";
pub const BLUE: &str = "#1f5fa8";
pub const RED: &str = "#c0392b";
pub const GREEN: &str = "#2e8b57";

pub struct Series {
    pub name: &'static str,
    pub colour: &'static str,
    /// Joined by a line, or drawn as discs of this radius.
    pub mark: Mark,
    /// Polylines, or points.
    pub lines: Vec<Vec<(f64, f64)>>,
}

/// A curve and the points it joins.
pub fn marked(name: &'static str, colour: &'static str, points: Vec<(f64, f64)>) -> [Series; 2] {
    let line = Series { name, colour, mark: Mark::Line(1.5), lines: vec![points.clone()] };
    [line, Series { name: "", colour, mark: Mark::Disc(2.5), lines: vec![points] }]
}

#[derive(Clone, Copy, PartialEq)]
pub enum Mark {
    Line(f64),
    Disc(f64),
}

pub struct Plot {
    pub title: String,
    pub x: String,
    pub y: String,
    /// Abscissa, ordinate: logarithms are drawn, of positive values.
    pub logarithmic: [bool; 2],
    /// The same scale along both axes.
    pub equal: bool,
    pub series: Vec<Series>,
}

/// From coordinates to pixels.
struct Frame {
    x: (f64, f64),
    y: (f64, f64),
}

impl Frame {
    fn of(plot: &Plot) -> Self {
        let all = || plot.series.iter().flat_map(|s| s.lines.iter().flatten());
        let span = |values: &mut dyn Iterator<Item = f64>| {
            let (low, high) = values.fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
            let margin = 0.04 * (high - low).max(1e-12);
            (low - margin, high + margin)
        };
        let x = span(&mut all().map(|p| plot.place(p).0));
        let y = span(&mut all().map(|p| plot.place(p).1));
        let mut frame = Self { x, y };
        if plot.equal {
            frame.equalise();
        }
        frame
    }

    fn equalise(&mut self) {
        let (width, height) = (WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM);
        let unit = ((self.x.1 - self.x.0) / width).max((self.y.1 - self.y.0) / height);
        for (span, pixels) in [(&mut self.x, width), (&mut self.y, height)] {
            let (middle, half) = (0.5 * (span.0 + span.1), 0.5 * unit * pixels);
            *span = (middle - half, middle + half);
        }
    }

    fn place(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let across = (x - self.x.0) / (self.x.1 - self.x.0);
        let up = (y - self.y.0) / (self.y.1 - self.y.0);
        (LEFT + across * (WIDTH - LEFT - RIGHT), HEIGHT - BOTTOM - up * (HEIGHT - TOP - BOTTOM))
    }
}

impl Plot {
    /// The point on the axes: logarithms where they are drawn.
    fn place(&self, &(x, y): &(f64, f64)) -> (f64, f64) {
        let scaled = |axis: usize, value: f64| if self.logarithmic[axis] { value.log10() } else { value };
        (scaled(0, x), scaled(1, y))
    }

    /// Places on the abscissa and their names: round values, or the points that discs mark on a logarithmic one.
    fn abscissae(&self, span: (f64, f64)) -> Vec<(f64, String)> {
        if !self.logarithmic[0] {
            return ticks(span, false).into_iter().map(|value| (value, text(value))).collect();
        }
        let discs = self.series.iter().filter(|series| matches!(series.mark, Mark::Disc(_)));
        let mut values: Vec<f64> =
            discs.flat_map(|series| series.lines.iter().flatten().map(|p| p.0)).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values.into_iter().map(|value| (value.log10(), text(value))).collect()
    }

    /// Places on the ordinate and their names: powers of ten on a long logarithmic one, digits between
    /// them on a short one.
    fn ordinates(&self, span: (f64, f64)) -> Vec<(f64, String)> {
        if !self.logarithmic[1] {
            return ticks(span, false).into_iter().map(|value| (value, text(value))).collect();
        }
        if span.1 - span.0 > LONG {
            return ticks(span, true).into_iter().map(|power| (power, format!("1e{power}"))).collect();
        }
        let decades = span.0.floor() as i32..=span.1.floor() as i32;
        let heads: &[f64] =
            if span.1 - span.0 > 1.0 { &[1.0, 2.0, 5.0] } else { &[1.0, 1.5, 2.0, 3.0, 5.0, 7.0] };
        let values = decades.flat_map(|power| heads.iter().map(move |head| head * 10f64.powi(power)));
        let places = values.map(|value| (value.log10(), text(value)));
        places.filter(|(place, _)| (span.0..=span.1).contains(place)).collect()
    }

    pub fn svg(&self) -> String {
        let frame = Frame::of(self);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
             font-family=\"sans-serif\" font-size=\"12\">\n<title>{0}</title>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
             <text x=\"{LEFT}\" y=\"24\" font-size=\"15\">{0}</text>\n",
            self.title
        );
        self.axes(&frame, &mut svg);
        for series in &self.series {
            self.draw(series, &frame, &mut svg);
        }
        self.legend(&mut svg);
        svg.push_str("</svg>\n");
        svg
    }

    fn axes(&self, frame: &Frame, svg: &mut String) {
        for (value, label) in self.abscissae(frame.x) {
            let (x, y) = (frame.place((value, frame.y.0)).0, HEIGHT - BOTTOM);
            let _ = write!(svg, "<path d=\"M{x:.1} {y}V{TOP}\" stroke=\"#eee\"/>");
            let _ = writeln!(
                svg,
                "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>",
                y + 18.0
            );
        }
        for (value, label) in self.ordinates(frame.y) {
            let y = frame.place((frame.x.0, value)).1;
            let _ = write!(svg, "<path d=\"M{LEFT} {y:.1}H{}\" stroke=\"#eee\"/>", WIDTH - RIGHT);
            let _ = writeln!(
                svg,
                "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
                LEFT - 6.0,
                y + 4.0
            );
        }
        let (middle, bottom) = (0.5 * (LEFT + WIDTH - RIGHT), HEIGHT - 16.0);
        let _ = writeln!(svg, "<text x=\"{middle}\" y=\"{bottom}\" text-anchor=\"middle\">{}</text>", self.x);
        let side = 0.5 * (TOP + HEIGHT - BOTTOM);
        let _ = writeln!(
            svg,
            "<text transform=\"translate(18 {side}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            self.y
        );
    }

    fn draw(&self, series: &Series, frame: &Frame, svg: &mut String) {
        for line in &series.lines {
            let places: Vec<_> = line.iter().map(|p| frame.place(self.place(p))).collect();
            match series.mark {
                Mark::Line(width) => {
                    let points: Vec<_> = places.iter().map(|p| format!("{:.1},{:.1}", p.0, p.1)).collect();
                    let (points, colour) = (points.join(" "), series.colour);
                    let _ = writeln!(svg, "<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"/>");
                }
                Mark::Disc(radius) => {
                    for (x, y) in places {
                        let _ = writeln!(
                            svg,
                            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{}\"/>",
                            series.colour
                        );
                    }
                }
            }
        }
    }

    fn legend(&self, svg: &mut String) {
        let mut x = LEFT;
        for series in self.series.iter().filter(|series| !series.name.is_empty()) {
            let _ = write!(
                svg,
                "<rect x=\"{x}\" y=\"32\" width=\"12\" height=\"6\" fill=\"{}\"/>",
                series.colour
            );
            let _ = writeln!(svg, "<text x=\"{}\" y=\"40\">{}</text>", x + 16.0, series.name);
            x += 40.0 + 6.5 * series.name.len() as f64;
        }
    }
}

/// Round values within the span.
fn ticks((low, high): (f64, f64), whole: bool) -> Vec<f64> {
    let rough = (high - low) / 6.0;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|f| f * power).into_iter().find(|s| *s >= rough).unwrap_or(rough);
    let step = if whole { step.max(1.0).round() } else { step };
    let first = (low / step).ceil() as i64;
    (first..=(high / step).floor() as i64).map(|k| k as f64 * step).collect()
}

fn text(value: f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}
