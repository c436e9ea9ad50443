//! A STEP file of a cube, written by hand: small enough to read, whole enough to import.

use std::fmt::Write;

/// An AP214 file of the cube from 0 to `size` in each direction, in the unit given.
pub fn cube(size: f64, unit: &str) -> String {
    let mut step = Step { text: String::new(), next: 1 };
    let corners: Vec<[f64; 3]> =
        (0..8).map(|i| [0, 1, 2].map(|bit| if i >> bit & 1 == 1 { size } else { 0.0 })).collect();
    let points: Vec<usize> = corners.iter().map(|c| step.point(*c)).collect();
    let vertices: Vec<usize> = points.iter().map(|p| step.add(&format!("VERTEX_POINT('',#{p})"))).collect();
    let mut edges = Vec::new();
    for from in 0..8_usize {
        for axis in 0..3 {
            if from >> axis & 1 == 0 {
                let to = from | 1 << axis;
                let direction = step.direction(axis, 1.0);
                let vector = step.add(&format!("VECTOR('',#{direction},1.)"));
                let line = step.add(&format!("LINE('',#{},#{vector})", points[from]));
                let edge =
                    step.add(&format!("EDGE_CURVE('',#{},#{},#{line},.T.)", vertices[from], vertices[to]));
                edges.push((from, to, edge));
            }
        }
    }
    let mut faces = Vec::new();
    for axis in 0..3 {
        for side in 0..2_usize {
            let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
            let corner = |s: usize, t: usize| side << axis | s << a | t << b;
            let mut ring = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            if side == 0 {
                ring.reverse();
            }
            let uses: Vec<String> = (0..4)
                .map(|i| {
                    let (from, to) = (ring[i], ring[(i + 1) % 4]);
                    let &(start, _, edge) = edges
                        .iter()
                        .find(|(s, e, _)| (*s, *e) == (from, to) || (*s, *e) == (to, from))
                        .expect("the edges of a cube");
                    let sense = if start == from { ".T." } else { ".F." };
                    let id = step.add(&format!("ORIENTED_EDGE('',*,*,#{edge},{sense})"));
                    format!("#{id}")
                })
                .collect();
            let ring_id = step.add(&format!("EDGE_LOOP('',({}))", uses.join(",")));
            let bound = step.add(&format!("FACE_OUTER_BOUND('',#{ring_id},.T.)"));
            let normal = step.direction(axis, if side == 1 { 1.0 } else { -1.0 });
            let reference = step.direction(a, 1.0);
            let frame =
                step.add(&format!("AXIS2_PLACEMENT_3D('',#{},#{normal},#{reference})", points[ring[0]]));
            let plane = step.add(&format!("PLANE('',#{frame})"));
            faces.push(step.add(&format!("ADVANCED_FACE('',(#{bound}),#{plane},.T.)")));
        }
    }
    let list: Vec<String> = faces.iter().map(|f| format!("#{f}")).collect();
    let shell = step.add(&format!("CLOSED_SHELL('',({}))", list.join(",")));
    let solid = step.add(&format!("MANIFOLD_SOLID_BREP('Cube',#{shell})"));
    step.product(solid, unit);
    format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n\
         FILE_NAME('cube.step','2020-01-01T00:00:00',(''),(''),'by hand','by hand','');\n\
         FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));\nENDSEC;\nDATA;\n{}ENDSEC;\nEND-ISO-10303-21;\n",
        step.text
    )
}

struct Step {
    text: String,
    next: usize,
}

impl Step {
    fn add(&mut self, record: &str) -> usize {
        writeln!(self.text, "#{}={record};", self.next).expect("a string takes all");
        self.next += 1;
        self.next - 1
    }

    fn point(&mut self, [x, y, z]: [f64; 3]) -> usize {
        self.add(&format!("CARTESIAN_POINT('',({x:?},{y:?},{z:?}))"))
    }

    fn direction(&mut self, axis: usize, sign: f64) -> usize {
        let mut d = [0.0; 3];
        d[axis] = sign;
        self.add(&format!("DIRECTION('',({:?},{:?},{:?}))", d[0], d[1], d[2]))
    }

    /// The product that the solid is the shape of, and its units.
    fn product(&mut self, solid: usize, unit: &str) {
        let millimetre = self.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
        let length = match unit {
            "inch" => {
                let dimensions = self.add("DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.)");
                let factor =
                    self.add(&format!("LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#{millimetre})"));
                self.add(&format!(
                    "(CONVERSION_BASED_UNIT('INCH',#{factor})LENGTH_UNIT()NAMED_UNIT(#{dimensions}))"
                ))
            }
            _ => millimetre,
        };
        let angle = self.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
        let solid_angle = self.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
        let context = self.add(&format!(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid_angle}))\
             REPRESENTATION_CONTEXT('',''))"
        ));
        let shape = self.add(&format!("ADVANCED_BREP_SHAPE_REPRESENTATION('',(#{solid}),#{context})"));
        let application = self.add("APPLICATION_CONTEXT('mechanical design')");
        let product_context = self.add(&format!("PRODUCT_CONTEXT('',#{application},'mechanical')"));
        let product = self.add(&format!("PRODUCT('Cube','Cube','',(#{product_context}))"));
        let formation = self.add(&format!("PRODUCT_DEFINITION_FORMATION('','',#{product})"));
        let design =
            self.add(&format!("PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')"));
        let definition = self.add(&format!("PRODUCT_DEFINITION('','',#{formation},#{design})"));
        let definition_shape = self.add(&format!("PRODUCT_DEFINITION_SHAPE('','',#{definition})"));
        self.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#{definition_shape},#{shape})"));
    }
}
