//! Units of a representation context (ISO 10303-41, measure schema), as factors to millimetres and radians.

use super::reader::{MAX_CHAIN, Mapped, Problem, Reader, problem, reference};
use super::value::Entity;
use crate::brep::{LengthUnit, Severity};
use std::f64::consts::PI;

/// Factors to our units.
#[derive(Debug, Clone, PartialEq)]
pub struct Units {
    /// Millimetres in one length unit.
    pub millimetres: f64,
    /// Radians in one plane angle unit.
    pub radians: f64,
    /// The length unit's name.
    pub name: String,
}

impl Default for Units {
    fn default() -> Self {
        Self { millimetres: 1.0, radians: 1.0, name: "mm".into() }
    }
}

impl Units {
    /// The length unit, for the model's source.
    pub fn length_unit(&self) -> LengthUnit {
        LengthUnit { name: self.name.clone(), millimetres: self.millimetres }
    }
}

/// What a unit measures, and its factor to millimetres or radians.
enum Unit {
    Length(f64, String),
    Angle(f64),
    Other,
}

/// The units of representation context `context`; millimetres with a warning where it has no length unit. A unit that cannot be
/// read costs itself.
pub fn of_context(reader: &mut Reader, context: Option<u64>) -> Units {
    let Some(context) = context else {
        let reason = "a representation has no context; lengths are taken as millimetres".into();
        reader.report(Severity::Warning, Problem { entity: 0, kind: "REPRESENTATION".into(), reason });
        return Units::default();
    };
    let Context { units, has_length, problems } = read_context(reader, context);
    if !has_length && problems.is_empty() {
        let reason = "no length unit; taken as millimetres".into();
        let kind = "GLOBAL_UNIT_ASSIGNED_CONTEXT".into();
        reader.report(Severity::Warning, Problem { entity: context, kind, reason });
    }
    for mut problem in problems {
        if !has_length {
            problem.reason += "; lengths are taken as millimetres";
        }
        reader.report(Severity::Warning, problem);
    }
    units
}

/// What a context says about units.
pub struct Context {
    pub units: Units,
    pub has_length: bool,
    /// Units that cannot be read, and such that were guessed by their names.
    pub problems: Vec<Problem>,
}

/// The units of a context.
pub fn read_context(reader: &Reader, context: u64) -> Context {
    let mut read = Context { units: Units::default(), has_length: false, problems: Vec::new() };
    let entity = match reader.entity(context) {
        Ok(entity) => entity,
        Err(problem) => {
            read.problems.push(problem);
            return read;
        }
    };
    let Some(assigned) = entity.record("GLOBAL_UNIT_ASSIGNED_CONTEXT") else { return read };
    // Of a complex instance the record holds the units alone; a simple one begins with identifier, type, dimension.
    for id in assigned.parameters.iter().filter_map(|p| p.list()).flatten().filter_map(|v| v.reference()) {
        let unit = unit(reader, id, 0).or_else(|problem| {
            let named = named_unit(reader, id);
            let reason = format!("{}; taken as what its name says", problem.reason);
            let problem = if named.is_some() { Problem { reason, ..problem } } else { problem };
            read.problems.push(problem);
            named.ok_or(())
        });
        match unit {
            Ok(Unit::Length(millimetres, name)) => {
                read.has_length = true;
                read.units.millimetres = millimetres;
                read.units.name = name;
            }
            Ok(Unit::Angle(radians)) => read.units.radians = radians,
            Ok(Unit::Other) | Err(()) => {}
        }
    }
    read
}

/// A conversion based unit whose conversion is of no use, by its name.
fn named_unit(reader: &Reader, id: u64) -> Option<Unit> {
    let entity = reader.entity(id).ok()?;
    let record = entity.record("CONVERSION_BASED_UNIT")?;
    let name = record.parameters.iter().find_map(|p| p.text())?.to_lowercase();
    Some(match &*name {
        "inch" | "in" => Unit::Length(25.4, name),
        "foot" | "ft" => Unit::Length(304.8, name),
        "yard" | "yd" => Unit::Length(914.4, name),
        "mil" | "thou" => Unit::Length(0.0254, name),
        "degree" | "degrees" | "deg" => Unit::Angle(PI / 180.0),
        "grad" | "gradian" | "gon" => Unit::Angle(PI / 200.0),
        _ => return None,
    })
}

fn unit(reader: &Reader, id: u64, depth: usize) -> Mapped<Unit> {
    let entity = reader.entity(id)?;
    if depth > MAX_CHAIN {
        return Err(problem(&entity, "units are defined by each other in a circle"));
    }
    if let Some(record) = entity.record("SI_UNIT") {
        // Prefix and name are the last two parameters, whether or not inherited dimensions stand before them.
        let count = record.parameters.len();
        let prefix = record.get(count.saturating_sub(2)).enumeration().unwrap_or_default();
        let name = record.get(count.saturating_sub(1)).enumeration().unwrap_or_default();
        let factor =
            si_prefix(&prefix).ok_or_else(|| problem(&entity, format!("unknown SI prefix {prefix}")))?;
        return Ok(match &*name {
            "METRE" => Unit::Length(factor * 1000.0, si_length_name(&prefix)),
            "RADIAN" => Unit::Angle(factor),
            _ => Unit::Other,
        });
    }
    if let Some(record) = entity.record("CONVERSION_BASED_UNIT") {
        return conversion_based(reader, &entity, record.parameters.len(), depth);
    }
    Ok(Unit::Other)
}

/// `CONVERSION_BASED_UNIT([dimensions,] name, measure with unit)`.
fn conversion_based(reader: &Reader, entity: &Entity, count: usize, depth: usize) -> Mapped<Unit> {
    let record = entity.record("CONVERSION_BASED_UNIT").expect("the caller found it");
    if count < 2 {
        return Err(problem(entity, "a conversion needs a name and a factor"));
    }
    let name = record.text(count - 2).to_lowercase();
    if !entity.is("LENGTH_UNIT") && !entity.is("PLANE_ANGLE_UNIT") && entity.records.len() > 1 {
        return Ok(Unit::Other);
    }
    let measure = reader.entity(reference(entity.id, record, count - 1)?)?;
    let base = measure.records.iter().find(|r| r.parameters.iter().any(|p| p.reference().is_some()));
    let factor = measure.records.iter().flat_map(|r| &r.parameters).find_map(|p| p.real());
    let base = base.and_then(|r| r.parameters.iter().find_map(|p| p.reference()));
    let (Some(base), Some(factor)) = (base, factor.filter(|f| *f > 0.0)) else {
        return Err(problem(&measure, "a conversion needs a positive factor and a unit"));
    };
    Ok(match unit(reader, base, depth + 1)? {
        Unit::Length(millimetres, _) => Unit::Length(factor * millimetres, name),
        Unit::Angle(radians) => Unit::Angle(factor * radians),
        Unit::Other => Unit::Other,
    })
}

fn si_prefix(name: &str) -> Option<f64> {
    let exponent = match name {
        "" => 0,
        "EXA" => 18,
        "PETA" => 15,
        "TERA" => 12,
        "GIGA" => 9,
        "MEGA" => 6,
        "KILO" => 3,
        "HECTO" => 2,
        "DECA" => 1,
        "DECI" => -1,
        "CENTI" => -2,
        "MILLI" => -3,
        "MICRO" => -6,
        "NANO" => -9,
        "PICO" => -12,
        "FEMTO" => -15,
        "ATTO" => -18,
        _ => return None,
    };
    Some(10_f64.powi(exponent))
}

fn si_length_name(prefix: &str) -> String {
    match prefix {
        "" => "m".into(),
        "MILLI" => "mm".into(),
        "CENTI" => "cm".into(),
        "MICRO" => "µm".into(),
        "KILO" => "km".into(),
        _ => format!("{}metre", prefix.to_lowercase()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::step::scan;

    fn units(data: &str) -> (Units, bool) {
        let text = format!("ISO-10303-21;DATA;{data}ENDSEC;");
        let reader = Reader::new(scan::index(text.as_bytes()));
        let context = read_context(&reader, 1);
        assert_eq!(context.problems, []);
        (context.units, context.has_length)
    }

    #[test]
    fn millimetres_and_degrees() {
        let (units, found) = units(
            "#1=(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNIT_ASSIGNED_CONTEXT((#2,#3,#7)) REPRESENTATION_CONTEXT('',''));\
             #2=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.));\
             #3=(CONVERSION_BASED_UNIT('DEGREE',#4) NAMED_UNIT(#6) PLANE_ANGLE_UNIT());\
             #4=PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(0.017453292519943295),#5);\
             #5=(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.));#6=DIMENSIONAL_EXPONENTS(0.,0.,0.,0.,0.,0.,0.);\
             #7=(NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT());",
        );
        assert!(found);
        assert_eq!((units.millimetres, units.name.as_str()), (1.0, "mm"));
        assert!((units.radians.to_degrees() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn inches_by_millimetres_or_centimetres() {
        for (prefix, factor) in [(".MILLI.", "25.4"), (".CENTI.", "2.54"), ("$", "2.54E-2")] {
            let (units, _) = units(&format!(
                "#1=(GLOBAL_UNIT_ASSIGNED_CONTEXT((#2)) REPRESENTATION_CONTEXT('',''));\
                 #2=(CONVERSION_BASED_UNIT('INCH',#4) LENGTH_UNIT() NAMED_UNIT(#6));\
                 #4=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE({factor}),#5);\
                 #5=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT({prefix},.METRE.));"
            ));
            assert!((units.millimetres - 25.4).abs() < 1e-12);
            assert_eq!(units.name, "inch");
        }
    }

    #[test]
    fn circles_and_absence() {
        let (units, found) = units("#1=REPRESENTATION_CONTEXT('','');");
        assert_eq!((units, found), (Units::default(), false));
        let text = "ISO-10303-21;DATA;#1=(GLOBAL_UNIT_ASSIGNED_CONTEXT((#2)));\
                    #2=(CONVERSION_BASED_UNIT('X',#3) LENGTH_UNIT());#3=LENGTH_MEASURE_WITH_UNIT(2.,#2);ENDSEC;";
        assert_eq!(read_context(&Reader::new(scan::index(text.as_bytes())), 1).problems.len(), 1);
    }

    #[test]
    fn a_unit_that_cannot_be_read_costs_itself() {
        let text = "ISO-10303-21;DATA;#1=(GLOBAL_UNIT_ASSIGNED_CONTEXT((#2,#3,#9)));\
            #2=(CONVERSION_BASED_UNIT('INCH',#8) LENGTH_UNIT());#3=(CONVERSION_BASED_UNIT('GON',#4) PLANE_ANGLE_UNIT());\
            #4=PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(0.9),#5);\
            #5=(CONVERSION_BASED_UNIT('DEGREE',#6) PLANE_ANGLE_UNIT());\
            #6=(MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(0.017453292519943295),#7) PLANE_ANGLE_MEASURE_WITH_UNIT());\
            #7=(PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.));ENDSEC;";
        let context = read_context(&Reader::new(scan::index(text.as_bytes())), 1);
        assert_eq!((context.units.millimetres, context.problems.len()), (25.4, 2));
        assert!((context.units.radians - PI / 200.0).abs() < 1e-15);
    }
}
