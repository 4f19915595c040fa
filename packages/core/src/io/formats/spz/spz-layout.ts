/** Bytes of the header; version 4 extends it. */
export const HEADER_BYTES = 16;
export const FLAG_ANTIALIASED = 1;

/** Factor of base colour coefficients, which are stored as bytes around the midpoint. */
export const COLOR_SCALE = 0.15;
