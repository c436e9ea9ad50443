//! Arrays of a picture's pixels in the system's huge pages.
//!
//! A picture's arrays are written once or twice in their life, so that what they cost is to a large part the system's: a page of 4 KB that is touched for the
//! first time takes a microsecond or more until it is there and cleared, one of 2 MB a tenth of that for each of its bytes. Linux gives huge pages to those who
//! ask for them, where it does not give them to all (`/sys/kernel/mm/transparent_hugepage/enabled`).

use bytemuck::NoUninit;

/// An array of `count` elements of `value`. What is 0 throughout is not touched before it is used.
pub(crate) fn filled<T: NoUninit>(value: T, count: usize) -> Vec<T> {
    if bytemuck::bytes_of(&value).iter().all(|&byte| byte == 0) {
        let array = vec![value; count];
        ask_for_huge_pages(&array);
        return array;
    }
    let mut array = Vec::with_capacity(count);
    ask_for_huge_pages(array.spare_capacity_mut());
    array.resize(count, value);
    array
}

/// What is in pages already stays there; whether the others become huge ones is up to the system.
#[cfg(target_os = "linux")]
fn ask_for_huge_pages<T>(array: &[T]) {
    const HUGE: usize = 1 << 21;
    let bytes = array.as_ptr_range();
    let (start, end) = ((bytes.start as usize).next_multiple_of(HUGE), bytes.end as usize / HUGE * HUGE);
    if start < end {
        // SAFETY: the range lies within the array, so it is mapped, and this advice changes neither what is there nor what may be done with it.
        unsafe { libc::madvise(start as *mut libc::c_void, end - start, libc::MADV_HUGEPAGE) };
    }
}

#[cfg(not(target_os = "linux"))]
fn ask_for_huge_pages<T>(_: &[T]) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_are_filled_whatever_their_size() {
        for count in [0, 1, 1000, 3_000_000] {
            for value in [0.0_f32, 1.5] {
                let array = filled(value, count);
                assert!(array.len() == count && array.iter().all(|&element| element == value), "{count}");
            }
        }
    }
}
