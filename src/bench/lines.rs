//! Lines over a linear pair of axes that start at 0, as SVG.

use super::plot::{COLORS, escaped};
use std::fmt::Write;

/// A line with a name.
#[derive(Debug, Clone, PartialEq)]
pub struct PlotLine {
    /// For the legend.
    pub name: String,
    /// From left to right; neither number below 0.
    pub points: Vec<[f64; 2]>,
}

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 420.0;
/// Left, top, right, bottom.
const MARGINS: [f64; 4] = [56.0, 40.0, 170.0, 48.0];

/// Ticks of an axis, at most.
const MOST_TICKS: f64 = 8.0;

/// The distance of ticks up to `greatest`: 1, 2 or 5 times a power of ten.
fn tick_distance(greatest: f64) -> f64 {
    let least = greatest / MOST_TICKS;
    let decade = 10.0_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|step| step * decade).find(|&step| step >= least).unwrap_or(least)
}

/// The text of the picture; `labels` are those of the axes. Points that are no numbers are left out.
pub fn lines_svg(title: &str, labels: [&str; 2], lines: &[PlotLine]) -> String {
    let usable = |point: &&[f64; 2]| point.iter().all(|x| x.is_finite() && *x >= 0.0);
    let shown = || lines.iter().flat_map(|line| &line.points).filter(usable);
    let greatest = [0, 1].map(|k| shown().map(|point| point[k]).fold(0.0, f64::max));
    let greatest = greatest.map(|x: f64| if x > 0.0 { x } else { 1.0 });
    let [left, top, right, bottom] = MARGINS;
    let (floor, end) = (HEIGHT - bottom, WIDTH - right);
    let x = |value: f64| left + value / greatest[0] * (end - left);
    let y = |value: f64| floor - value / greatest[1] * (floor - top);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#ffffff\"/>\n\
         <text x=\"{left}\" y=\"22\" font-size=\"15\">{}</text>\n",
        escaped(title)
    );
    let mut line = |text: std::fmt::Arguments<'_>| {
        // Writing to a String cannot fail.
        let _ = writeln!(svg, "{text}");
    };
    for axis in 0..2 {
        let distance = tick_distance(greatest[axis]);
        for tick in 0..=(greatest[axis] / distance + 1e-9) as u32 {
            let value = (f64::from(tick) * distance * 1e9).round() / 1e9;
            let (at_x, at_y) = (x(value), y(value));
            if axis == 0 {
                line(format_args!("<path d=\"M{at_x:.1} {floor}V{top}\" stroke=\"#dddddd\"/>"));
                let below = floor + 16.0;
                line(format_args!(
                    "<text x=\"{at_x:.1}\" y=\"{below}\" text-anchor=\"middle\">{value}</text>"
                ));
            } else {
                line(format_args!("<path d=\"M{left} {at_y:.1}H{end}\" stroke=\"#dddddd\"/>"));
                let (before, under) = (left - 6.0, at_y + 4.0);
                line(format_args!(
                    "<text x=\"{before}\" y=\"{under:.1}\" text-anchor=\"end\">{value}</text>"
                ));
            }
        }
    }
    let (middle, under) = ((left + end) / 2.0, HEIGHT - 10.0);
    line(format_args!(
        "<text x=\"{middle}\" y=\"{under}\" text-anchor=\"middle\">{}</text>",
        escaped(labels[0])
    ));
    let middle = (top + floor) / 2.0;
    line(format_args!(
        "<text transform=\"translate(16 {middle}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        escaped(labels[1])
    ));
    for (index, PlotLine { name, points }) in lines.iter().enumerate() {
        let color = COLORS[index % COLORS.len()];
        let dash = if index < COLORS.len() { "" } else { " stroke-dasharray=\"5 3\"" };
        let path: Vec<String> =
            points.iter().filter(usable).map(|p| format!("{:.1},{:.1}", x(p[0]), y(p[1]))).collect();
        line(format_args!(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\"{dash}/>",
            path.join(" ")
        ));
        let (at, row) = (end + 12.0, top + 10.0 + 18.0 * index as f64);
        line(format_args!("<path d=\"M{at} {row}h18\" stroke=\"{color}\"{dash}/>"));
        let (after, base) = (at + 24.0, row + 4.0);
        line(format_args!("<text x=\"{after}\" y=\"{base}\">{}</text>", escaped(name)));
    }
    svg.push_str("</svg>\n");
    svg
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_run_from_the_origin_to_the_greatest_numbers() {
        let line =
            |name: &str, points: &[[f64; 2]]| PlotLine { name: name.to_owned(), points: points.to_vec() };
        let lines = [line("a & b", &[[0.0, 0.0], [5.0, 2.0]]), line("c", &[[2.5, 1.0], [f64::NAN, 9.0]])];
        let svg = lines_svg("one", ["degree", "time"], &lines);
        let (end, floor) = (WIDTH - MARGINS[2], HEIGHT - MARGINS[3]);
        let path = format!("points=\"{:.1},{floor:.1} {end:.1},{:.1}\"", MARGINS[0], MARGINS[1]);
        assert!(svg.contains(&path) && svg.contains("a &amp; b"), "{svg}");
        let middle = format!("points=\"{:.1},{:.1}\"", (MARGINS[0] + end) / 2.0, (MARGINS[1] + floor) / 2.0);
        assert!(svg.contains(&middle), "{svg}");
        assert!(lines_svg("none", ["", ""], &[]).ends_with("</svg>\n"));
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!([15.0, 8.0, 100.0].map(tick_distance), [2.0, 1.0, 20.0]);
        assert!((tick_distance(0.9) - 0.2).abs() < 1e-12);
    }
}
