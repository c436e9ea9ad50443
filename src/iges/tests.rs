use crate::trimming::{TrimOptions, trim_face};

#[test]
fn debug_trims() {
    let path = std::env::var("IGS").unwrap();
    let model = super::read(&std::fs::read(path).unwrap()).unwrap();
    for id in model.faces.ids() {
        let face = &model.faces[id];
        let only = std::env::var("DE").ok().map(|s| s.parse::<u64>().unwrap());
        if only.is_some_and(|d| d != face.entity) {
            continue;
        }
        println!("face {} surface {:?}", face.entity, model.surfaces[face.surface]);
        for l in &face.loops {
            if let crate::brep::TrimLoop::Edges(c) = l {
                for c in c {
                    let e = &model.edges[c.edge];
                    println!(
                        "   edge {:?} {} rev {} range {:?} {} -> {} kind {}",
                        c.edge,
                        e.entity,
                        c.reversed,
                        e.range,
                        e.curve.point(e.range[0]),
                        e.curve.point(e.range[1]),
                        format!("{:?}", e.curve).chars().take(60).collect::<String>()
                    );
                }
            }
        }
        match trim_face(&model, id, &TrimOptions::default()) {
            Ok(t) => {
                println!(
                    "  window {:?} {} curves, dev {} repairs {:?}",
                    t.window,
                    t.curves.len(),
                    t.deviation,
                    t.repairs
                );
                for c in t.curves.iter().take(60) {
                    println!(
                        "     {} -> {}",
                        crate::geometry::Homogeneous::point(c.points[0]),
                        crate::geometry::Homogeneous::point(*c.points.last().unwrap())
                    );
                }
            }
            Err(e) => println!("  ERR {e}"),
        }
    }
}
