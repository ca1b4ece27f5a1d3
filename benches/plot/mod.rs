//! Pictures as SVG: lines and points over two axes.

use std::fmt::Write;

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 440.0;
const LEFT: f64 = 80.0;
const RIGHT: f64 = 20.0;
const TOP: f64 = 50.0;
const BOTTOM: f64 = 60.0;

pub struct Series {
    pub name: &'static str,
    pub colour: &'static str,
    /// Joined by a line, or drawn as discs of this radius.
    pub mark: Mark,
    /// Polylines, or points.
    pub lines: Vec<Vec<(f64, f64)>>,
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
    /// Ordinate by powers of ten.
    pub logarithmic: bool,
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
        let x = span(&mut all().map(|p| p.0));
        let y = span(&mut all().map(|p| plot.ordinate(p.1)));
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

    fn place(&self, x: f64, y: f64) -> (f64, f64) {
        let across = (x - self.x.0) / (self.x.1 - self.x.0);
        let up = (y - self.y.0) / (self.y.1 - self.y.0);
        (LEFT + across * (WIDTH - LEFT - RIGHT), HEIGHT - BOTTOM - up * (HEIGHT - TOP - BOTTOM))
    }
}

impl Plot {
    fn ordinate(&self, y: f64) -> f64 {
        if self.logarithmic {
            y.log10()
        } else {
            y
        }
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
        for value in ticks(frame.x, false) {
            let (x, y) = (frame.place(value, frame.y.0).0, HEIGHT - BOTTOM);
            let _ = write!(svg, "<path d=\"M{x:.1} {y}V{TOP}\" stroke=\"#eee\"/>");
            let _ = writeln!(
                svg,
                "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                y + 18.0,
                text(value)
            );
        }
        for value in ticks(frame.y, self.logarithmic) {
            let y = frame.place(frame.x.0, value).1;
            let label = if self.logarithmic { format!("1e{value}") } else { text(value) };
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
            let places: Vec<_> = line.iter().map(|p| frame.place(p.0, self.ordinate(p.1))).collect();
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
