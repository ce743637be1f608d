//! What holds for every figure: whole files, finite numbers, readable letters, few bytes.

use super::*;
use resvg::usvg;

fn cloud(n: usize) -> Vec<(f64, f64)> {
    let scatter = |i: usize, m: usize| ((i * m) % 9973) as f64 / 9973.0;
    (0..n)
        .map(|i| (scatter(i, 7919), scatter(i, 6007)))
        .collect()
}

fn figure() -> Figure {
    let wave: Vec<(f64, f64)> = (0..50)
        .map(|i| (i as f64 / 50.0, ((i * 7) % 50) as f64 / 50.0))
        .collect();
    let band = wave.iter().map(|(x, y)| (*x, y - 0.2, y + 0.2)).collect();
    let first = Panel::new(Axis::new("Contraction, ε* (–)"), Axis::new("F_{620} (N)"))
        .with(Layer::windows(
            "plateau",
            vec![(0.1, 0.2), (0.4, 9.0), (-3.0, -2.0)],
        ))
        .with(Layer::band("95 % band", band, Ink::Blue))
        .with(Layer::zero())
        .with(Series::marks(
            "cloud",
            cloud(5000),
            Mark::filled(Shape::Dot, Ink::Grey),
        ))
        .with(Series::line(
            "model <new> & \"old\"",
            wave.clone(),
            Stroke::new(Ink::Blue, Dash::Dashed),
        ))
        .with(
            Series::marks(
                "measured",
                wave.clone(),
                Mark::open(Shape::Square, Ink::Vermilion),
            )
            .with_y_errors(wave.iter().map(|(_, y)| (y - 0.1, y + 0.1)).collect()),
        );
    let second = Panel::new(Axis::new("l_{rest} (mm)"), Axis::new("R^2"))
        .with(Series::line(
            "",
            vec![
                (0.0, 1.0),
                (f64::NAN, 2.0),
                (1.0, f64::INFINITY),
                (2.0, 3.0),
            ],
            Stroke::new(Ink::Green, Dash::Solid),
        ))
        .with(Layer::identity("y = x"))
        .with(Layer::text("\\v{n} = 12", Place::Plot(0.6, 0.2)))
        .same_range();
    Figure::new("A test", DOUBLE_MM, 70.0)
        .grid(2)
        .with(first)
        .with(second)
}

#[test]
fn files_are_whole_and_finite_and_repeat_themselves() {
    let svg = figure().to_svg().unwrap();
    let tree = usvg::Tree::from_str(&svg, &usvg::Options::default()).unwrap();
    assert!((tree.size().width() / 96.0 * 25.4 - 175.0).abs() < 0.01);
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    assert!(!svg.contains("<text"));
    assert_eq!(svg, figure().to_svg().unwrap());
}

#[test]
fn letters_and_lines_are_large_enough_for_print() {
    let svg = figure().to_svg().unwrap();
    let numbers = |name: &str| -> Vec<f64> {
        let attribute = format!("{name}=\"");
        let parts = svg.split(&attribute).skip(1);
        parts
            .filter_map(|p| p.split('"').next()?.parse().ok())
            .collect()
    };
    let sizes = numbers("data-pt");
    assert!(
        sizes.len() > 20 && sizes.iter().all(|s| *s >= 5.0),
        "{sizes:?}"
    );
    let widths = numbers("stroke-width");
    assert!(widths.iter().all(|w| *w >= units::pt(0.5)), "{widths:?}");
}

#[test]
fn thousands_of_points_stay_small() {
    let svg = figure().to_svg().unwrap();
    assert!(svg.len() < 120_000, "{} bytes", svg.len());
    let series: Vec<(f64, f64)> = cloud(60_000)
        .into_iter()
        .enumerate()
        .map(|(i, p)| (i as f64, p.1))
        .collect();
    let panel = Panel::new(Axis::new("t"), Axis::new("F")).with(Series::line(
        "",
        series,
        Stroke::new(Ink::Black, Dash::Solid),
    ));
    let long = Figure::new("Long", DOUBLE_MM, 60.0)
        .with(panel)
        .to_svg()
        .unwrap();
    assert!(long.len() < 150_000, "{} bytes", long.len());
}

#[test]
fn labels_carry_their_words() {
    let svg = figure().to_svg().unwrap();
    for words in [
        "F_620 (N)",
        "l_rest (mm)",
        "(A)",
        "(B)",
        "model &lt;new&gt; &amp; &quot;old&quot;",
    ] {
        assert!(svg.contains(&format!("aria-label=\"{words}\"")), "{words}");
    }
}

#[test]
fn a_figure_without_room_is_refused() {
    let tiny = Figure {
        width_mm: 20.0,
        ..figure()
    };
    assert!(
        tiny.to_svg()
            .unwrap_err()
            .to_string()
            .contains("do not fit")
    );
    assert!(Figure::new("Empty", SINGLE_MM, 50.0).to_svg().is_err());
}

#[test]
fn a_shared_legend_names_every_series_once() {
    let count = |svg: &str| svg.matches("aria-label=\"measured\"").count();
    let double = Figure {
        panels: vec![figure().panels[0].clone(), figure().panels[0].clone()],
        ..figure()
    };
    assert_eq!(count(&double.to_svg().unwrap()), 2);
    assert_eq!(count(&double.shared_legend().to_svg().unwrap()), 1);
}

#[test]
fn a_legend_beside_makes_the_panel_narrower() {
    let panel = figure().panels[0].clone();
    let beside = Figure::new("", DOUBLE_MM, 60.0).with(panel.clone().legend(Legend::Beside));
    let above = Figure::new("", DOUBLE_MM, 60.0).with(panel.legend(Legend::Above));
    assert!(frame(&beside)[2] < frame(&above)[2] - 1000.0);
    assert!(frame(&beside)[1] < frame(&above)[1]);
}

/// Left edge, upper edge, width and height of the first panel's axes, from the path that draws them.
fn frame(figure: &Figure) -> Vec<f64> {
    let svg = figure.to_svg().unwrap();
    let paths = svg.split("<path d=\"M").skip(1);
    let axes = paths.filter(|p| p.contains("stroke=\"#000000\"") && p.contains("l0 "));
    let mut data = axes.map(|p| p.split('"').next().unwrap().to_string());
    let longest = data.find(|d| d.split(['l', ' ']).count() == 6).unwrap();
    let numbers: Vec<f64> = longest
        .split(['l', ' '])
        .map(|n| n.parse().unwrap())
        .collect();
    vec![numbers[0], numbers[1], numbers[4], numbers[3]]
}

#[test]
fn a_legend_moves_above_where_the_panel_is_full() {
    let full = Panel::new(Axis::new("x"), Axis::new("y")).with(Series::marks(
        "everywhere",
        cloud(3000),
        Mark::filled(Shape::Circle, Ink::Blue),
    ));
    let free = Panel {
        legend: Legend::None,
        ..full.clone()
    };
    let top = |panel: Panel| frame(&Figure::new("", SINGLE_MM, 60.0).with(panel))[1];
    assert!(top(full) > top(free) + 300.0);
}

/// A panel with so many named series, in the middle where no legend has room.
fn crowd(count: usize, name: impl Fn(usize) -> String) -> Panel {
    let empty = Panel::new(Axis::new("x"), Axis::new("y"));
    (0..count).fold(empty, |panel, k| {
        let (ink, shape, _) = look(k);
        let mark = Mark::open(shape, ink);
        panel.with(Series::marks(&name(k), cloud(30), mark))
    })
}

/// How many of the entries `member 0`, `member 1` and so on a figure's legend shows.
fn shown(svg: &str) -> usize {
    svg.matches("aria-label=\"member ").count()
}

#[test]
fn a_legend_that_is_too_long_counts_what_it_leaves_out() {
    let name = |k: usize| format!("member {k}");
    for count in [5, 120, 1000] {
        let panel = || crowd(count, name);
        let double = || Figure::new("", DOUBLE_MM, 82.0).grid(2);
        let all = [
            double().shared_legend().with(panel()).with(panel()),
            Figure::new("", SINGLE_MM, 68.0).with(panel()),
            Figure::new("", SINGLE_MM, 68.0).with(panel().legend(Legend::Above)),
            Figure::new("", DOUBLE_MM, 90.0).with(panel().legend(Legend::Beside)),
        ];
        for (k, figure) in all.into_iter().enumerate() {
            let svg = figure.to_svg().unwrap();
            let shown = shown(&svg);
            let left_out = format!("aria-label=\"and {} more\"", count - shown);
            assert_eq!(shown < count, count > 5, "figure {k}: {shown}");
            assert_eq!(
                svg.contains(&left_out),
                shown < count,
                "figure {k}: {shown}"
            );
            assert!(shown >= 5, "figure {k}: {shown}");
        }
    }
}

#[test]
fn names_of_any_length_leave_room_for_the_data() {
    let long = |k: usize| format!("member {k} {}", "of a very long name ".repeat(12));
    for legend in [Legend::Auto, Legend::Above, Legend::Beside] {
        let panel = crowd(9, long).legend(legend);
        let wide = Figure::new("", DOUBLE_MM, 90.0).with(panel.clone());
        assert!(wide.to_svg().is_ok(), "{legend:?}");
        let shared = Figure::new("", SINGLE_MM, 70.0).shared_legend();
        assert!(shared.with(panel).to_svg().is_ok());
    }
    let names: Vec<String> = (0..300).map(long).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    for count in [1, 2, 40, 300] {
        let categories = || Axis::categories("names", &names[..count]);
        let across = Panel::new(categories(), Axis::new("y"));
        let up = Panel::new(Axis::new("x"), categories()).title(names[0]);
        let figure = Figure::new("", SINGLE_MM, 60.0).grid(2);
        let svg = figure.with(across).with(up).to_svg().unwrap();
        let ticks = svg.matches("aria-label=\"member ").count();
        assert!(ticks > 1 && ticks <= 2 * count + 1 && ticks < 40, "{ticks}");
    }
}
