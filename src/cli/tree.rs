//! The product tree as text, from the paths of the placed parts.

use std::collections::HashMap;

/// Deeper levels are indented no further.
const MAX_INDENT: usize = 32;

/// Lines of a tree, indented; like siblings (same name, same contents) are one line with their number.
pub(super) fn lines<'a>(paths: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    let mut nodes = vec![Node::default()];
    let mut index_of: HashMap<(usize, &str), usize> = HashMap::new();
    for path in paths {
        let mut parent = 0;
        let mut names = path.split('/').peekable();
        while let Some(name) = names.next() {
            let is_leaf = names.peek().is_none();
            if let (false, Some(&known)) = (is_leaf, index_of.get(&(parent, name))) {
                parent = known;
                continue;
            }
            nodes.push(Node { name, children: Vec::new() });
            let index = nodes.len() - 1;
            nodes[parent].children.push(index);
            if !is_leaf {
                index_of.insert((parent, name), index);
            }
            parent = index;
        }
    }
    let mut lines = Vec::new();
    // Depth first without recursion: a hostile path may be long.
    let mut open: Vec<(usize, usize, usize)> =
        grouped(&nodes, 0).into_iter().rev().map(|(n, c)| (n, c, 0)).collect();
    while let Some((node, count, depth)) = open.pop() {
        let times = if count > 1 { format!(" × {count}") } else { String::new() };
        let name = if nodes[node].name.is_empty() { "(unnamed)" } else { nodes[node].name };
        lines.push(format!("{}{name}{times}", "  ".repeat(depth.min(MAX_INDENT))));
        open.extend(grouped(&nodes, node).into_iter().rev().map(|(n, c)| (n, c, depth + 1)));
    }
    lines
}

#[derive(Default)]
struct Node<'a> {
    name: &'a str,
    children: Vec<usize>,
}

/// The children of a node: leaves of one name as one, with their number.
fn grouped(nodes: &[Node<'_>], node: usize) -> Vec<(usize, usize)> {
    let mut groups: Vec<(usize, usize)> = Vec::new();
    let mut group_of: HashMap<&str, usize> = HashMap::new();
    for &child in &nodes[node].children {
        if !nodes[child].children.is_empty() {
            groups.push((child, 1));
            continue;
        }
        let group = *group_of.entry(nodes[child].name).or_insert(groups.len());
        match groups.get_mut(group) {
            Some((_, count)) => *count += 1,
            None => groups.push((child, 1)),
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn siblings_are_counted_and_branches_indented() {
        let paths = ["car/wheel/bolt", "car/wheel/bolt", "car/wheel/rim", "car/body", ""];
        assert_eq!(lines(paths), ["car", "  wheel", "    bolt × 2", "    rim", "  body", "(unnamed)"]);
    }

    #[test]
    fn a_long_path_does_not_overflow() {
        let path = "a/".repeat(50_000);
        assert_eq!(lines([path.as_str()]).len(), 50_001);
    }
}
