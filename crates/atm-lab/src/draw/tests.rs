use atm_core::{Isometry2, Point2, Vector2};
use resvg::tiny_skia::Pixmap;
use roxmltree::Document;

use super::*;

fn point(x: f64, y: f64) -> Point2<f64> {
    Point2::new(x, y)
}

/// A frame in which a metre is 100 pixels in a picture 432 pixels wide, without a title: its panel begins at (16, 16).
fn frame() -> Frame {
    Frame::new(point(0.0, 0.0), point(4.0, 2.0)).unwrap()
}

fn picture(scene: Scene) -> Picture {
    let panels = vec![Panel { scene, ..Panel::default() }];
    Picture { panels, frame: Some(frame()), width: Some(432.0), ..Picture::default() }
}

fn svg(scene: Scene) -> String {
    picture(scene).svg()
}

/// The `d` of the first path of a class; legends come last.
fn path<'a>(document: &'a Document<'_>, class: &str) -> Option<&'a str> {
    let found = document.descendants().find(|node| node.attribute("class") == Some(class));
    found.and_then(|node| node.attribute("d"))
}

/// How often the pen is set down in what a scene draws of a class.
fn count(scene: Scene, class: &str) -> usize {
    let svg = svg(scene);
    let document = Document::parse(&svg).unwrap();
    path(&document, class).map_or(0, |d| d.matches('M').count())
}

fn cone(x: f64, y: f64, yaw: f64) -> Cone {
    Cone { sensor: Isometry2::new(Vector2::new(x, y), yaw), range: 1.0, half_beam: 0.2 }
}

fn colour(pixels: &Pixmap, x: u32, y: u32) -> (u8, u8, u8) {
    let pixel = pixels.pixel(x, y).unwrap();
    (pixel.red(), pixel.green(), pixel.blue())
}

const WHITE: (u8, u8, u8) = (255, 255, 255);
const BLUE: (u8, u8, u8) = (0, 0x72, 0xb2);

#[test]
fn a_mark_stands_where_its_point_is() {
    let mut scene = Scene::new();
    scene.marks("median", [point(1.0, 0.5)]);
    // 1 m right of the panel's left side, 1.5 m below its top; a disc of radius 3.5 begins at its left.
    let svg = svg(scene);
    assert!(path(&Document::parse(&svg).unwrap(), "median").unwrap().starts_with("M112.5 166a3.5 3.5"), "{svg}");
}

#[test]
fn every_mark_arc_and_wall_within_the_frame_is_drawn_once() {
    let places = |count: u32| (0..count).map(|i| point(0.1 + 0.01 * f64::from(i), 1.0));
    let mut scene = Scene::new();
    scene.marks("median", places(37));
    scene.marks("center", places(5).chain([point(9.0, 1.0)]));
    scene.arcs("arcs", (0..12).map(|i| cone(2.0, 1.0, f64::from(i))).chain([cone(9.0, 9.0, 0.0)]));
    scene.walls("rough", [Wall::Straight([point(-50.0, 1.5), point(1e9, 1.5)]), Wall::Round(point(3.0, 1.0), 0.1)]);
    scene.segments("mckerrow", [[point(0.0, 0.0), point(1.0, 1.0)], [point(-1.0, 0.0), point(-1.0, 1.0)]]);
    assert_eq!(count(scene.clone(), "median"), 37);
    assert_eq!(count(scene.clone(), "center"), 5);
    assert_eq!(count(scene.clone(), "arcs"), 12);
    assert_eq!((count(scene.clone(), "rough"), count(scene.clone(), "rough post")), (1, 1));
    assert_eq!(count(scene.clone(), "s0"), 1);
}

#[test]
fn marks_left_out_are_counted_unless_the_frame_was_chosen() {
    let mut scene = Scene::new();
    scene.marks("median", (0..100).map(|i| point(f64::from(i) * 0.1, 1.0)).chain([point(1e6, 0.0)]));
    assert!(!svg(scene.clone()).contains("outside"));
    let automatic = Picture { frame: None, ..picture(scene) };
    assert!(automatic.svg().contains(">1 mark lies outside<"));
}

#[test]
fn more_arcs_are_drawn_fainter() {
    let mut scene = Scene::new();
    scene.arcs("arcs", (0..1000).map(|i| cone(2.0, 1.0, f64::from(i))));
    assert_eq!((count(scene.clone(), "faint"), count(scene, "partners")), (1000, 0));
}

#[test]
fn an_arc_ends_at_the_edges_of_its_beam() {
    let mut scene = Scene::new();
    scene.arcs("arcs", [cone(1.0, 1.0, 0.0)]);
    // cos 0.2 = 0.980067, sin 0.2 = 0.198669; the right end comes first, which is lower on the page.
    let svg = svg(scene);
    let document = Document::parse(&svg).unwrap();
    assert_eq!(path(&document, "arcs"), Some("M214.007 135.867A100 100 0 0 0 214.007 96.133"));
}

#[test]
fn cells_of_one_shade_are_joined_and_empty_ones_left_out() {
    let values = vec![1.0, 1.0, 0.0, 1.0, f64::NAN, -7.0, 0.5, 9.0];
    let mut scene = Scene::new();
    scene.grid(Grid { corner: point(0.0, 0.0), cell: 0.5, columns: 4, values });
    let svg = svg(scene);
    let document = Document::parse(&svg).unwrap();
    // Lower row: two cells in one, and one. Upper row: the last, full as well; the one before half full.
    assert_eq!(path(&document, "g5"), Some("M16 166h100v50h-100zM166 166h50v50h-50zM166 116h50v50h-50z"));
    assert_eq!(path(&document, "g2"), Some("M116 116h50v50h-50z"));
    assert_eq!(svg.matches("\"g").count(), 3, "a shade too many, the legend's aside");
}

#[test]
fn a_path_is_one_line_with_its_gaps_and_without_points_that_no_eye_parts() {
    let mut scene = Scene::new();
    let way = [point(0.0, 1.0), point(0.001, 1.0), point(1.0, 1.0), point(9.0, 1.0)].map(Some);
    scene.path(way.into_iter().chain([None, Some(point(3.0, 0.5)), Some(point(3.0, 0.0))]));
    let svg = svg(scene);
    assert_eq!(path(&Document::parse(&svg).unwrap(), "path"), Some("M16 116L116 116L416 116M316 166L316 216"));
}

#[test]
fn an_opening_says_its_width_and_what_the_marks_leave_free() {
    let mut scene = Scene::new();
    scene.openings([[point(1.0, 1.0), point(2.0, 1.0)]]);
    let bare = svg(scene.clone());
    assert!(bare.contains("opening: 39 in (1.00 m)") && !bare.contains(">free"), "{bare}");
    scene.marks("median", [point(1.0, 1.0), point(1.25, 1.0), point(2.0, 1.0)]);
    scene.marks("truth", [point(1.6, 1.0)]);
    assert!(svg(scene.clone()).contains(">free: 30 in (0.75 m)<"));
    let one_jamb = scene.only(|name| name != "median");
    assert!(!svg(one_jamb.clone()).contains("free:"), "the truth is no claim");
    let mut one_jamb = one_jamb;
    one_jamb.marks("single", [point(1.0, 1.0)]);
    assert!(svg(one_jamb).contains("no points on its jambs"));
}

#[test]
fn panels_stand_side_by_side_and_explain_each_mark_once() {
    let panel = |title: &str| {
        let mut scene = Scene::new();
        scene.marks("median", [point(1.0, 1.0)]);
        Panel { title: title.to_owned(), subtitle: "as <seen> & \"said\"".to_owned(), scene }
    };
    let picture =
        Picture { title: "two".to_owned(), panels: vec![panel("left"), panel("right")], ..Picture::default() };
    let svg = picture.svg();
    let document = Document::parse(&svg).unwrap();
    let texts: Vec<&str> = document.descendants().filter(|n| n.has_tag_name("text")).filter_map(|n| n.text()).collect();
    assert_eq!(texts.iter().filter(|text| **text == "median").count(), 1);
    assert_eq!(texts.iter().filter(|text| **text == "as <seen> & \"said\"").count(), 2);
    let borders = document.descendants().filter(|node| node.attribute("class") == Some("border"));
    let sides: Vec<(f64, f64)> = borders
        .map(|node| ["x", "width"].map(|name| node.attribute(name).unwrap().parse::<f64>().unwrap()))
        .map(|[x, width]| (x, x + width))
        .collect();
    assert!(sides.len() == 2 && sides[0].1 < sides[1].0 && sides[1].1 <= 884.0, "{sides:?}");
}

#[test]
fn panels_of_the_same_size_stand_in_rows() {
    // A 2 : 1 frame, 432 px wide: two columns of (432 − 2 · 16 − 20) / 2 = 190 px by 95; a heading of 20 above each row, 20 between rows.
    let panel = |title: &str| Panel { title: title.to_owned(), ..Panel::default() };
    let panels = ["a", "b", "c"].map(panel).to_vec();
    let picture = Picture { panels, columns: Some(2), ..picture(Scene::new()) };
    let svg = picture.svg();
    let document = Document::parse(&svg).unwrap();
    let number = |node: &roxmltree::Node<'_, '_>, name| node.attribute(name).unwrap().parse::<f64>().unwrap();
    let borders = document.descendants().filter(|node| node.attribute("class") == Some("border"));
    let places: Vec<[f64; 4]> =
        borders.map(|node| ["x", "y", "width", "height"].map(|name| number(&node, name))).collect();
    assert_eq!(places, [[16.0, 36.0, 190.0, 95.0], [226.0, 36.0, 190.0, 95.0], [16.0, 171.0, 190.0, 95.0]]);
    let texts = document.descendants().filter(|node| node.has_tag_name("text"));
    let third = texts.filter(|node| node.text() == Some("c")).map(|node| (number(&node, "x"), number(&node, "y")));
    assert_eq!(third.collect::<Vec<_>>(), [(16.0, 163.0)], "a line of 20 above the panel, its letters on 12");
}

#[test]
fn any_name_and_title_give_well_formed_xml() {
    let nasty = "<b>\u{0}\u{1b}[31m&amp; ]]> \" ' \u{ffff} 日本 \u{202e}";
    let mut scene = Scene::new();
    scene.marks(nasty, [point(1.0, 1.0)]);
    scene.segments(nasty, [[point(0.0, 0.0), point(1.0, 1.0)]]);
    scene.walls(nasty, [Wall::Round(point(1.0, 1.0), 0.2)]);
    let mut picture = picture(scene);
    picture.title = nasty.to_owned();
    Document::parse(&picture.svg()).unwrap();
    picture.png(1.0).unwrap();
}

#[test]
fn the_same_scene_gives_the_same_bytes() {
    let scene = || {
        let mut scene = Scene::new();
        for name in ["b", "a", "median", "near"] {
            scene.marks(name, (0..50).map(|i| point(f64::from(i).sin() + 2.0, f64::from(i).cos() + 1.0)));
        }
        scene
    };
    assert_eq!(svg(scene()), svg(scene()));
}

#[test]
fn coordinates_of_any_size_leave_the_picture_whole() {
    for far in [9.9e3, 1e12, 1e200, f64::MAX, f64::INFINITY, f64::NAN] {
        let mut scene = Scene::new();
        scene.marks("median", [point(far, 0.0), point(1.0, -far)]);
        scene.arcs("arcs", [Cone { range: far, ..cone(far, 1.0, 0.0) }]);
        scene.path([Some(point(-far, 1.0)), Some(point(far, 1.0)), Some(point(1.0, far))]);
        scene.walls("rough", [Wall::Straight([point(-far, far), point(far, 1.0)]), Wall::Round(point(1.0, 1.0), far)]);
        scene.openings([[point(0.0, 0.0), point(far, far)]]);
        scene.segments("s", [[point(far, far), point(0.0, 0.0)]]);
        for frame in [None, Some(frame())] {
            let picture = Picture { frame, ..picture(scene.clone()) };
            let svg = picture.svg();
            Document::parse(&svg).unwrap();
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{far}: {svg}");
            picture.png(1.0).unwrap();
        }
    }
}

#[test]
fn an_empty_scene_says_so_and_one_point_is_seen() {
    assert!(svg(Scene::new()).contains("nothing to draw"));
    let picture = Picture::default();
    assert!(picture.svg().contains("nothing to draw"));
    let mut scene = Scene::new();
    scene.marks("near", [point(1e12, -1e12)]);
    let picture = Picture { panels: vec![Panel { scene, ..Panel::default() }], ..Picture::default() };
    assert!(!picture.svg().contains("outside"));
}

#[test]
fn png_has_the_size_asked_for_and_shows_what_the_svg_says() {
    let mut scene = Scene::new();
    scene.marks("median", [point(1.0, 0.5)]);
    let picture = Picture { height: Some(300.0), ..picture(scene) };
    let pixels = Pixmap::decode_png(&picture.png(1.0).unwrap()).unwrap();
    assert_eq!((pixels.width(), pixels.height()), (432, 300));
    let double = Pixmap::decode_png(&picture.png(2.0).unwrap()).unwrap();
    assert_eq!((double.width(), double.height()), (864, 600));
    // A picture higher than the frame shows more above and below: the frame's middle stays in the panel's, which leaves 38
    // pixels for the legend and 16 for the margin: (16 + 262) / 2 = 139.
    assert_eq!(colour(&pixels, 116, 189), BLUE);
    assert_eq!(colour(&pixels, 130, 189), WHITE);
}

#[test]
fn letters_are_drawn_without_fonts_on_the_machine() {
    let picture = Picture { title: "HHHH".to_owned(), ..picture(Scene::new()) };
    let pixels = Pixmap::decode_png(&picture.png(2.0).unwrap()).unwrap();
    let dark = (32..100).flat_map(|x| (30..60).map(move |y| (x, y))).filter(|&(x, y)| colour(&pixels, x, y).0 < 64);
    assert!(dark.count() > 200);
}

#[test]
fn sizes_are_brought_within_bounds_and_pixels_are_limited() {
    let picture = |width: f64| Picture { width: Some(width), height: Some(width), ..Picture::default() };
    assert!(picture(1.0).svg().contains("width=\"64\" height=\"64\""));
    assert!(picture(f64::NAN).svg().contains("width=\"900\""));
    assert!(picture(1e9).svg().contains("width=\"16384\""));
    let refused = picture(16_384.0).png(1.0).unwrap_err().to_string();
    assert!(refused.contains("16384 x 16384 pixels"), "{refused}");
    assert!(picture(100.0).png(f64::NAN).is_err() && picture(100.0).png(-1.0).is_err());
}
