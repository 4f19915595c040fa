/** The catalogue of hard cases in a module of its own, to be imported dynamically: the first scripts lack it. */
export { HARD_CASES } from '@websplatter/conformance';
