import { keepText, keptText } from './storage.ts';

/** Where the chosen theme is kept; none while the system's is followed. */
const KEY = 'websplatter-theme';
/** Told to `window` when a person has changed the theme. */
const THEME_CHANGE = 'themechange';

const isSystemDark = () => matchMedia('(prefers-color-scheme: dark)').matches;

/** Gives the page the theme that was chosen last. */
export function applyTheme(): void {
  const theme = keptText(KEY);
  if (theme === 'light' || theme === 'dark') document.documentElement.dataset.theme = theme;
}

/** Changes to the other theme; the system's own is followed again where that is it. */
export function toggleTheme(): void {
  const { dataset } = document.documentElement;
  const system = isSystemDark() ? 'dark' : 'light';
  const other = (dataset.theme ?? system) === 'dark' ? 'light' : 'dark';
  if (other === system) delete dataset.theme;
  else dataset.theme = other;
  keepText(KEY, other === system ? null : other);
  dispatchEvent(new Event(THEME_CHANGE));
}

/** Calls `onChange` when the system's or the chosen theme changes; returns a function that stops this. */
export function observeTheme(onChange: () => void): () => void {
  const scheme = matchMedia('(prefers-color-scheme: dark)');
  scheme.addEventListener('change', onChange);
  addEventListener(THEME_CHANGE, onChange);
  return () => {
    scheme.removeEventListener('change', onChange);
    removeEventListener(THEME_CHANGE, onChange);
  };
}
