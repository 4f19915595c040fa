/**
 * Focuses `element` after a pointer press. Browsers treat focus set by a script as keyboard focus
 * and would outline it. Style sheets therefore exclude elements with `data-pointer-focus`.
 */
export function focusByPointer(element: HTMLElement): void {
  element.dataset.pointerFocus = '';
  element.addEventListener('blur', () => delete element.dataset.pointerFocus, { once: true });
  element.focus({ preventScroll: true });
}
