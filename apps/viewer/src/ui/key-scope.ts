/**
 * Keys that move the focus, a slider or a scrolled area, or press a button, if the scene has no
 * focus.
 */
const NAVIGATION_KEYS = /^(Arrow.*|Page(Up|Down)|Home|End| )$/;

/** Whether a key may move the camera, given the focused element. */
export function mayMoveCamera(scope: KeyScope, key: string): boolean {
  return scope === 'scene' || !NAVIGATION_KEYS.test(key);
}

/** The focused element: the scene, a text field, an open list, or another control. */
type KeyScope = 'scene' | 'text' | 'open list' | 'control';

const TEXT_FIELDS = 'textarea, input:not([type="range"], [type="checkbox"], [type="color"])';

export function keyScope(target: EventTarget | null): KeyScope {
  if (!(target instanceof HTMLElement) || target.matches('body, .viewport')) return 'scene';
  if (target.matches('select')) return isOpen(target) ? 'open list' : 'text';
  const isText = target.isContentEditable || target.matches(TEXT_FIELDS);
  return isText ? 'text' : 'control';
}

/** Browsers that cannot report the state count as open. */
function isOpen(select: HTMLElement): boolean {
  return !CSS.supports('selector(:open)') || select.matches(':open');
}

/**
 * A key press with Ctrl or the command key as the list of commands has it, such as `ctrl+z`; null for
 * others. Ctrl+Shift+Z redoes as Ctrl+Y does.
 */
export function controlKey({
  key,
  ctrlKey,
  metaKey,
  shiftKey,
  altKey,
}: Pick<KeyboardEvent, 'key' | 'ctrlKey' | 'metaKey' | 'shiftKey' | 'altKey'>): string | null {
  if (!(ctrlKey || metaKey) || altKey) return null;
  const lower = key.toLowerCase();
  if (shiftKey) return lower === 'z' ? 'ctrl+y' : null;
  return `ctrl+${lower}`;
}
