/** Elsewhere these move the focus, a slider or a scrolled area, or press a button. */
const NAVIGATION_KEYS = /^(Arrow.*|Page(Up|Down)|Home|End| )$/;

/** Whether a key that moves the camera does so where the keyboard is. */
export function mayMoveCamera(scope: KeyScope, key: string): boolean {
  return scope === 'scene' || !NAVIGATION_KEYS.test(key);
}

/** Holder of the keyboard: the scene, a text field, a list that letters choose from, or other. */
type KeyScope = 'scene' | 'text' | 'open list' | 'control';

const TEXT_FIELDS = 'textarea, input:not([type="range"], [type="checkbox"], [type="color"])';

export function keyScope(target: EventTarget | null): KeyScope {
  if (!(target instanceof HTMLElement) || target.matches('body, .viewport')) return 'scene';
  if (target.matches('select')) return isOpen(target) ? 'open list' : 'text';
  const isText = target.isContentEditable || target.matches(TEXT_FIELDS);
  return isText ? 'text' : 'control';
}

/** Browsers that cannot tell keep the key for the list. */
function isOpen(select: HTMLElement): boolean {
  return !CSS.supports('selector(:open)') || select.matches(':open');
}
