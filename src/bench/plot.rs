//! Points over a logarithmic pair of axes, as SVG.

use std::fmt::Write;

/// A measured setting.
#[derive(Debug, Clone, PartialEq)]
pub struct PlotPoint {
    /// Points of one series have one colour and are joined.
    pub series: String,
    /// To the right; above 0.
    pub x: f64,
    /// Upwards; above 0.
    pub y: f64,
}

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 420.0;
/// Left, top, right, bottom.
const MARGINS: [f64; 4] = [64.0, 40.0, 150.0, 48.0];

/// Labels that fit side by side below the plot, but one.
const MOST_LABELS: i32 = 8;

/// Colour-blind safe (Okabe and Ito 2008).
pub(super) const COLORS: [&str; 7] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"];

/// The whole decades around `values`; one where there are none.
fn decades(values: impl Iterator<Item = f64> + Clone) -> [i32; 2] {
    let (low, high) =
        values.fold((f64::INFINITY, 0.0f64), |(low, high), value| (low.min(value), high.max(value)));
    if low > high {
        return [0, 1];
    }
    let low = low.log10().floor() as i32;
    [low, (high.log10().ceil() as i32).max(low + 1)]
}

/// The text of the picture; `labels` are those of the axes. Points without logarithms are left out.
pub fn logarithmic_svg(title: &str, labels: [&str; 2], points: &[PlotPoint]) -> String {
    let usable = |p: &&PlotPoint| p.x > 0.0 && p.x.is_finite() && p.y > 0.0 && p.y.is_finite();
    let shown: Vec<&PlotPoint> = points.iter().filter(usable).collect();
    let across = decades(shown.iter().map(|p| p.x));
    let upwards = decades(shown.iter().map(|p| p.y));
    let [left, top, right, bottom] = MARGINS;
    let share = |value: f64, [low, high]: [i32; 2]| (value.log10() - f64::from(low)) / f64::from(high - low);
    let x = |value: f64| left + share(value, across) * (WIDTH - left - right);
    let y = |value: f64| HEIGHT - bottom - share(value, upwards) * (HEIGHT - top - bottom);
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
    let (floor, ceiling, end) = (HEIGHT - bottom, top, WIDTH - right);
    let labelled = (across[1] - across[0] + MOST_LABELS - 1) / MOST_LABELS;
    for decade in across[0]..=across[1] {
        let at = x(10f64.powi(decade));
        line(format_args!("<path d=\"M{at:.1} {floor}V{ceiling}\" stroke=\"#dddddd\"/>"));
        if (across[1] - decade) % labelled == 0 {
            let below = floor + 16.0;
            line(format_args!("<text x=\"{at:.1}\" y=\"{below}\" text-anchor=\"middle\">1e{decade}</text>"));
        }
    }
    for decade in upwards[0]..=upwards[1] {
        let at = y(10f64.powi(decade));
        line(format_args!("<path d=\"M{left} {at:.1}H{end}\" stroke=\"#dddddd\"/>"));
        let (before, under) = (left - 6.0, at + 4.0);
        line(format_args!("<text x=\"{before}\" y=\"{under:.1}\" text-anchor=\"end\">1e{decade}</text>"));
    }
    let (middle, under) = ((left + end) / 2.0, HEIGHT - 10.0);
    let [label_x, label_y] = labels.map(escaped);
    line(format_args!("<text x=\"{middle}\" y=\"{under}\" text-anchor=\"middle\">{label_x}</text>"));
    let middle = (top + floor) / 2.0;
    line(format_args!(
        "<text transform=\"translate(16 {middle}) rotate(-90)\" text-anchor=\"middle\">{label_y}</text>"
    ));
    let mut names: Vec<&str> = Vec::new();
    for point in &shown {
        if !names.contains(&point.series.as_str()) {
            names.push(&point.series);
        }
    }
    for (index, name) in names.iter().enumerate() {
        let color = COLORS[index % COLORS.len()];
        let own: Vec<[f64; 2]> =
            shown.iter().filter(|p| p.series == *name).map(|p| [x(p.x), y(p.y)]).collect();
        let path: Vec<String> = own.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        line(format_args!("<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\"/>", path.join(" ")));
        for [x, y] in own {
            line(format_args!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\" fill=\"{color}\"/>"));
        }
        let (at, row) = (end + 16.0, top + 10.0 + 18.0 * index as f64);
        line(format_args!("<circle cx=\"{at}\" cy=\"{row}\" r=\"4\" fill=\"{color}\"/>"));
        let (after, base) = (at + 10.0, row + 4.0);
        line(format_args!("<text x=\"{after}\" y=\"{base}\">{}</text>", escaped(name)));
    }
    svg.push_str("</svg>\n");
    svg
}

pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_stand_where_their_logarithms_are() {
        let point = |x, y| PlotPoint { series: "a < b".to_owned(), x, y };
        let svg = logarithmic_svg(
            "one",
            ["across", "upwards"],
            &[point(1e-6, 100.0), point(1e-4, 1000.0), point(0.0, 5.0)],
        );
        let right = WIDTH - MARGINS[2];
        assert!(
            svg.contains(&format!("cx=\"{:.1}\" cy=\"{:.1}\"", MARGINS[0], HEIGHT - MARGINS[3])),
            "{svg}"
        );
        assert!(svg.contains(&format!("cx=\"{right:.1}\" cy=\"{:.1}\"", MARGINS[1])), "{svg}");
        assert_eq!(svg.matches("r=\"3.5\"").count(), 2, "{svg}");
        assert!(svg.contains("a &lt; b") && svg.ends_with("</svg>\n"));
    }

    #[test]
    fn nothing_to_show_is_no_fault() {
        assert!(logarithmic_svg("none", ["", ""], &[]).ends_with("</svg>\n"));
    }
}
