/** The catalogue alone, always imported dynamically: the viewer's first scripts leave it out. */
export { HARD_CASES } from '@websplatter/conformance';
