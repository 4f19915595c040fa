/**
 * Gives `element` the keyboard because a pointer touched it. Browsers take the focus that a script
 * gives for that of a keyboard, and would show where it is: style sheets leave elements out that
 * carry `data-pointer-focus`.
 */
export function focusByPointer(element: HTMLElement): void {
  element.dataset.pointerFocus = '';
  element.addEventListener('blur', () => delete element.dataset.pointerFocus, { once: true });
  element.focus({ preventScroll: true });
}
