//! Several pictures on one sheet.

use crate::image::Film;
use crate::render::Background;

/// Cells of a sheet: columns and rows, as nearly square as leaves at most one row ragged.
pub(super) fn grid(cells: usize) -> [usize; 2] {
    let rows = cells.max(1).isqrt();
    [cells.max(1).div_ceil(rows), rows]
}

/// The films, all of one size, from left to right and from the top; empty cells have the background.
pub(super) fn sheet(films: Vec<Film>, background: Background) -> Film {
    let [columns, rows] = grid(films.len());
    let mut films = films.into_iter();
    let Some(first) = films.next() else { return Film::new(0, 0) };
    if films.len() == 0 {
        return first;
    }
    let (width, height) = (first.width, first.height);
    let mut sheet = Film::with_layers_of(&first, columns * width, rows * height);
    for (cell, film) in std::iter::once(first).chain(films).enumerate() {
        sheet.paste(&film, cell % columns * width, cell / columns * height);
    }
    background.put_behind(&mut sheet);
    sheet
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_are_nearly_square() {
        let grids = [1, 2, 3, 4, 5, 6, 7, 8, 9, 14].map(grid);
        assert_eq!(grids, [[1, 1], [2, 1], [3, 1], [2, 2], [3, 2], [3, 2], [4, 2], [4, 2], [3, 3], [5, 3]]);
    }

    #[test]
    fn cells_are_in_reading_order_and_the_rest_is_background() {
        let film = |light: f32| {
            let mut film = Film::new(2, 1);
            film.color.fill([light, light, light, 1.0]);
            film
        };
        let films = (1..=5).map(|index| film(index as f32)).collect();
        let sheet = sheet(films, Background::Color([1.0, 0.0, 0.0]));
        assert_eq!((sheet.width, sheet.height), (6, 2));
        let reds: Vec<f32> = sheet.color.iter().map(|color| color[0]).collect();
        assert_eq!(reds, [1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 5.0, 5.0, 1.0, 1.0]);
        assert_eq!(sheet.color[11], [1.0, 0.0, 0.0, 1.0]);
    }
}
