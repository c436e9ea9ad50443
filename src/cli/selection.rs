//! `--only`, `--hide` and `--focus` on models and on scenes that are baked already.
//!
//! A model is chosen from before it is baked, so that what is hidden costs nothing. Of a baked scene instances and faces are left out. Both know the same names
//! and numbers, but for the numbers of placements, which a scene has not.

use super::Failure;
use super::args_select::SelectionArguments;
use super::pattern::Pattern;
use crate::bake::{KeptScene, keep};
use crate::brep::{Model, Subject, select, subjects};
use crate::scene::Scene;
use std::collections::{BTreeSet, HashMap};
use std::path::Path;

/// Names in the error for a pattern that means nothing.
const MOST_NAMES: usize = 12;

/// Whether a pattern means the subject itself.
fn means(pattern: &Pattern, subject: Subject<'_>) -> bool {
    match subject {
        Subject::Place { path, name, entities } => pattern.means_place(path, name, &entities),
        Subject::Body(entity) | Subject::Face(entity) => pattern.means_entity(entity),
    }
}

fn any_means(patterns: &[Pattern], subject: Subject<'_>) -> bool {
    patterns.iter().any(|pattern| means(pattern, subject))
}

/// Leaves of a model what is wanted.
///
/// # Errors
///
/// A pattern that means nothing.
pub(super) fn select_of_model(
    model: &mut Model,
    selection: &SelectionArguments,
    path: &Path,
) -> Result<(), Failure> {
    if selection.is_all() {
        return Ok(());
    }
    let mut census = Census::new(selection.only.iter().chain(&selection.hide));
    subjects(model, &mut |subject| census.count(subject));
    census.check(path)?;
    let is_only = |subject: Subject<'_>| any_means(&selection.only, subject);
    let is_hidden = |subject: Subject<'_>| any_means(&selection.hide, subject);
    select(model, (!selection.only.is_empty()).then_some(&is_only), &is_hidden);
    Ok(())
}

/// The part of a scene that is wanted; nothing where that is all of it.
///
/// # Errors
///
/// A pattern that means nothing.
pub(super) fn select_of_scene(
    scene: &Scene<'_>,
    selection: &SelectionArguments,
    path: &Path,
) -> anyhow::Result<Option<Box<KeptScene>>> {
    if selection.is_all() {
        return Ok(None);
    }
    let mut census = Census::new(selection.only.iter().chain(&selection.hide));
    let only = Choice::of(scene, &selection.only, &mut census);
    let hide = Choice::of(scene, &selection.hide, &mut census);
    census.check(path)?;
    let takes_all = selection.only.is_empty();
    // A part is shown whole if it is meant as a whole anywhere.
    let mut has_meant_faces = vec![false; scene.parts.len()];
    let mut is_whole = vec![takes_all; scene.parts.len()];
    for (face, _) in scene.faces.iter().zip(&only.faces).filter(|(_, is_meant)| **is_meant) {
        has_meant_faces[face.part as usize] = true;
    }
    for (instance, _) in scene.instances.iter().zip(&only.instances).filter(|(_, is_meant)| **is_meant) {
        is_whole[instance.part as usize] = true;
    }
    let keeps_instance = |index: usize| {
        let is_meant =
            takes_all || only.instances[index] || has_meant_faces[scene.instances[index].part as usize];
        is_meant && !hide.instances[index]
    };
    let keeps_face = |index: usize| {
        (is_whole[scene.faces[index].part as usize] || only.faces[index]) && !hide.faces[index]
    };
    let instances: Vec<bool> = (0..scene.instances.len()).map(keeps_instance).collect();
    let faces: Vec<bool> = (0..scene.faces.len()).map(keeps_face).collect();
    let kept =
        keep(scene, &instances, &faces).map_err(|reason| anyhow::anyhow!("{}: {reason}", path.display()))?;
    Ok(Some(Box::new(kept)))
}

/// What each of some patterns means in a scene.
///
/// # Errors
///
/// A pattern that means nothing.
pub(super) fn meant(scene: &Scene<'_>, patterns: &[&Pattern], path: &Path) -> Result<Vec<Choice>, Failure> {
    let mut census = Census::new(patterns.iter().copied());
    let mut choices = Vec::with_capacity(patterns.len());
    for &pattern in patterns {
        choices.push(Choice::of(scene, std::slice::from_ref(pattern), &mut census));
    }
    census.check(path)?;
    Ok(choices)
}

/// What some patterns mean in a scene, a truth for each instance and each face: one by one, without what follows from it.
pub(super) struct Choice {
    pub(super) instances: Vec<bool>,
    pub(super) faces: Vec<bool>,
}

impl Choice {
    fn of<'p>(scene: &Scene<'_>, patterns: &'p [Pattern], census: &mut Census<'p>) -> Self {
        let mut test = |subject: Subject<'_>| {
            census.count(subject);
            any_means(patterns, subject)
        };
        // Places above an instance are tested once, not for each instance below them.
        let mut known: HashMap<String, bool> = HashMap::new();
        let instances = scene.instances.iter().zip(&scene.metadata.instances);
        let instances = instances.map(|(instance, info)| {
            let entity = scene.metadata.parts[instance.part as usize].entity;
            let mut is_meant = false;
            let ends = info.path.match_indices('/').map(|(at, _)| at);
            for end in ends {
                let above = &info.path[..end];
                is_meant |= match known.get(above) {
                    Some(&known) => known,
                    None => {
                        let meant = test(place(above, 0));
                        known.insert(above.to_owned(), meant);
                        meant
                    }
                };
            }
            test(place(&info.path, entity)) || is_meant
        });
        let instances = instances.collect();
        let bodies: Vec<bool> =
            scene.body_infos.iter().map(|body| test(Subject::Body(body.entity))).collect();
        let faces = scene.faces.iter().zip(scene.face_infos);
        let faces = faces.map(|(face, info)| {
            let of_body = bodies.get(face.body as usize).copied().unwrap_or_default();
            test(Subject::Face(info.entity)) || of_body
        });
        Self { instances, faces: faces.collect() }
    }
}

fn place(path: &str, entity: u64) -> Subject<'_> {
    let name = path.rsplit('/').next().unwrap_or_default();
    Subject::Place { path, name, entities: [entity, 0] }
}

/// Which patterns mean anything, and what there is to mean.
struct Census<'p> {
    patterns: Vec<(&'p Pattern, bool)>,
    names: BTreeSet<String>,
}

impl<'p> Census<'p> {
    fn new(patterns: impl Iterator<Item = &'p Pattern>) -> Self {
        Self { patterns: patterns.map(|pattern| (pattern, false)).collect(), names: BTreeSet::new() }
    }

    fn count(&mut self, subject: Subject<'_>) {
        for (pattern, has_meaning) in &mut self.patterns {
            *has_meaning = *has_meaning || means(pattern, subject);
        }
        if let Subject::Place { name, .. } = subject
            && !name.is_empty()
            && !self.names.contains(name)
        {
            self.names.insert(name.to_owned());
        }
    }

    fn check(&self, path: &Path) -> Result<(), Failure> {
        let Some((pattern, _)) = self.patterns.iter().find(|(_, has_meaning)| !has_meaning) else {
            return Ok(());
        };
        let hint = match pattern {
            Pattern::Entity(_) => "no part, body or face has that number".to_owned(),
            Pattern::Glob(glob) => self.hint(glob),
        };
        Err(Failure::Usage(format!("{}: nothing matches `{pattern}`: {hint}", path.display())))
    }

    /// Names that are like the last of a glob's, or else the first few.
    fn hint(&self, glob: &str) -> String {
        let wanted = glob.rsplit('/').next().unwrap_or_default().replace(['*', '?'], "").to_lowercase();
        let is_like = |name: &&String| {
            let name = name.to_lowercase();
            !wanted.is_empty()
                && (name.contains(&wanted) || distance(&wanted, &name) <= wanted.chars().count() / 3)
        };
        let near: Vec<&String> = self.names.iter().filter(is_like).take(MOST_NAMES).collect();
        let (lead, names) = match near.is_empty() {
            false => ("there is ", near),
            true => ("the names are ", self.names.iter().take(MOST_NAMES).collect()),
        };
        let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
        let more = if lead == "the names are " && self.names.len() > MOST_NAMES {
            format!(" and {} more (trimray info -v shows all)", self.names.len() - MOST_NAMES)
        } else {
            String::new()
        };
        format!("{lead}{}{more}", quoted.join(", "))
    }
}

/// Insertions, deletions and substitutions between two words (Levenshtein); of long ones more than any that count.
fn distance(a: &str, b: &str) -> usize {
    const LONGEST: usize = 64;
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    if a.len().max(b.len()) > LONGEST {
        return usize::MAX;
    }
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_have_distances() {
        assert_eq!([distance("bolt", "bold"), distance("bolt", "volts"), distance("", "abc")], [1, 2, 3]);
        assert_eq!(distance(&"a".repeat(100), "a"), usize::MAX);
    }

    #[test]
    fn what_means_nothing_is_told_with_what_is_like_it() {
        let patterns: Vec<Pattern> =
            ["Bold", "zzz", "#7"].iter().map(|text| text.parse().expect("any")).collect();
        let error = |index: usize| {
            let mut census = Census::new(patterns[index..=index].iter());
            for path in ["Car", "Car/Bolt M6", "Car/Bolt", "Car/Rim"] {
                census.count(place(path, 1));
            }
            census.check(Path::new("car.step")).expect_err("it means nothing").to_string()
        };
        assert_eq!(error(0), "car.step: nothing matches `Bold`: there is `Bolt`");
        assert_eq!(
            error(1),
            "car.step: nothing matches `zzz`: the names are `Bolt`, `Bolt M6`, `Car`, `Rim`"
        );
        assert_eq!(error(2), "car.step: nothing matches `#7`: no part, body or face has that number");
    }
}
