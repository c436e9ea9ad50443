//! What an import takes at its height, counted by the allocator: less than four times the file, its bytes included, plus the model.
//!
//! One test in a program of its own, so that nothing else is counted.

use std::alloc::{GlobalAlloc, Layout, System};
use std::fmt::Write;
use std::sync::atomic::{AtomicUsize, Ordering};

static LIVE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

/// The system's allocator, counting bytes in use. Blocks that grow count once: large ones are moved by their pages.
struct Counting;

fn took(bytes: usize) {
    PEAK.fetch_max(LIVE.fetch_add(bytes, Ordering::Relaxed) + bytes, Ordering::Relaxed);
}

// SAFETY: all is left to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        took(layout.size());
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(block, layout) }
    }
    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        LIVE.fetch_sub(layout.size(), Ordering::Relaxed);
        took(size);
        // SAFETY: as the caller promises.
        unsafe { System.realloc(block, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn step(data: &str) -> String {
    format!("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n{data}\nENDSEC;\nEND-ISO-10303-21;\n")
}

/// `count` squares beside each other in one shell, with an edge loop each.
fn plates(count: usize) -> String {
    let mut text = String::from("#1=SHELL_BASED_SURFACE_MODEL('',(#2));\n#3=DIRECTION('',(0.,0.,1.));\n");
    let mut faces = String::new();
    for i in 0..count {
        let id = |k: usize| 10 + 40 * i + k;
        write!(faces, "{}#{}", if i == 0 { "" } else { "," }, id(0)).expect("a string takes all");
        writeln!(
            text,
            "#{}=ADVANCED_FACE('',(#{}),#{},.T.);\n#{}=FACE_OUTER_BOUND('',#{},.T.);\n#{}=PLANE('',#{});\n\
             #{}=AXIS2_PLACEMENT_3D('',#{},#3,$);\n#{}=EDGE_LOOP('',(#{},#{},#{},#{}));",
            id(0),
            id(1),
            id(2),
            id(1),
            id(4),
            id(2),
            id(3),
            id(3),
            id(10),
            id(4),
            id(20),
            id(21),
            id(22),
            id(23)
        )
        .expect("a string takes all");
        for k in 0..4 {
            let (x, y) = (i as f64 + [0.0, 0.9, 0.9, 0.0][k], [0.0, 0.0, 1.0, 1.0][k]);
            let [dx, dy] = [[1, 0], [0, 1], [-1, 0], [0, -1]][k];
            let next = (k + 1) % 4;
            writeln!(
                text,
                "#{}=CARTESIAN_POINT('',({x:.6},{y:.6},0.000000));\n#{}=VERTEX_POINT('',#{});\n\
                 #{}=ORIENTED_EDGE('',*,*,#{},.T.);\n#{}=EDGE_CURVE('',#{},#{},#{},.T.);\n#{}=LINE('',#{},#{});\n\
                 #{}=VECTOR('',#{},1.);\n#{}=DIRECTION('',({dx}.,{dy}.,0.));",
                id(10 + k), id(14 + k), id(10 + k), id(20 + k), id(24 + k), id(24 + k), id(14 + k), id(14 + next),
                id(28 + k), id(28 + k), id(10 + k), id(32 + k), id(32 + k), id(36 + k), id(36 + k)
            )
            .expect("a string takes all");
        }
    }
    step(&format!("{text}#2=OPEN_SHELL('',({faces}));"))
}

/// Points, as many as there is room for, in records of 80 columns.
fn iges_points(count: usize) -> String {
    let record = |data: &str, letter: char, number: usize| format!("{data:<72}{letter}{number:>7}\n");
    let mut text = record("", 'S', 1)
        + &record("1H,,1H;,,,,,32,38,6,308,15,,1.,2,2HMM,1,0.1,,1E-6,10.,,,11,0,;", 'G', 1);
    for i in 0..count {
        let number = 2 * i + 1;
        let first = format!("     116{:>8}{1:>8}{1:>8}{1:>8}{1:>8}{1:>8}{1:>8}00000000", i + 1, 0);
        text += &record(&first, 'D', number);
        text += &record(&format!("     116{0:>8}{0:>8}{1:>8}{0:>8}", 0, 1), 'D', number + 1);
    }
    for i in 0..count {
        text += &record(&format!("{:<64}{:>8}", format!("116,{i}.,0.,0.,0;"), 2 * i + 1), 'P', i + 1);
    }
    text + &record("S      1G      1", 'T', 1)
}

#[test]
fn imports_take_less_than_four_times_the_file() {
    const LENGTH: usize = 16 << 20;
    let tiny = (1..LENGTH / 12).map(|i| format!("#{i}=A(#{i});\n")).collect::<String>();
    let face = "#1=SHELL_BASED_SURFACE_MODEL('',(#2));#2=OPEN_SHELL('',(#3));#3=ADVANCED_FACE('',(),#4,.T.);";
    for (what, text) in [
        ("plates", plates(LENGTH / 2000)),
        ("tiny entities", step(&tiny)),
        ("a string", step(&format!("{face}#4=PLANE('{}',$);", "a".repeat(LENGTH)))),
        ("faults", step(&format!("{face}#4=PLANE('',$);{}", ";".repeat(LENGTH)))),
        (
            "broken faces",
            step(
                &(1..LENGTH / 40)
                    .map(|i| format!("#{i}=ADVANCED_FACE('',(),#{i},.T.);\n"))
                    .collect::<String>(),
            ),
        ),
        ("points", iges_points(LENGTH / 240)),
    ] {
        let before = LIVE.load(Ordering::Relaxed);
        PEAK.store(before, Ordering::Relaxed);
        let model = match trimray::step::read(text.as_bytes()) {
            Ok(model) => model,
            Err(_) => trimray::iges::read(text.as_bytes()).expect("a file with entities"),
        };
        let kept = LIVE.load(Ordering::Relaxed) - before;
        let peak = PEAK.load(Ordering::Relaxed) - before;
        let times = (peak - kept) as f64 / text.len() as f64;
        eprintln!(
            "{what}: {} bytes, {times:.2} times that beside the model's {kept}, {} faces",
            text.len(),
            model.faces.len()
        );
        assert!(times < 3.0, "{what}: {times:.2} times the file");
        drop(model);
    }
}
