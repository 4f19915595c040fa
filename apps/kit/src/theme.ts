import { keepText, keptText } from './storage.ts';

/** Storage key of the chosen theme; absent while the system's theme applies. */
const KEY = 'websplatter-theme';
/** Event on `window` after the user has changed the theme. */
const THEME_CHANGE = 'themechange';

const isSystemDark = () => matchMedia('(prefers-color-scheme: dark)').matches;

/** Applies the stored theme to the page. */
export function applyTheme(): void {
  const theme = keptText(KEY);
  if (theme === 'light' || theme === 'dark') document.documentElement.dataset.theme = theme;
}

/** Switches to the other theme. If that is the system's, the page follows the system again. */
export function toggleTheme(): void {
  const { dataset } = document.documentElement;
  const system = isSystemDark() ? 'dark' : 'light';
  const other = (dataset.theme ?? system) === 'dark' ? 'light' : 'dark';
  if (other === system) delete dataset.theme;
  else dataset.theme = other;
  keepText(KEY, other === system ? null : other);
  dispatchEvent(new Event(THEME_CHANGE));
}

/** Calls `onChange` when the effective theme changes; returns a function that stops this. */
export function observeTheme(onChange: () => void): () => void {
  const scheme = matchMedia('(prefers-color-scheme: dark)');
  scheme.addEventListener('change', onChange);
  addEventListener(THEME_CHANGE, onChange);
  return () => {
    scheme.removeEventListener('change', onChange);
    removeEventListener(THEME_CHANGE, onChange);
  };
}
