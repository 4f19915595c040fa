import { cases } from './cases.ts';

declare global {
  interface Window {
    cases: typeof cases;
  }
}

window.cases = cases;
