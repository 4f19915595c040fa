// Shared by the reader and the writer of SOG.

/** Entries of a palette in a row of its image. */
export const PALETTE_COLUMNS = 64;

/** Values of the two bytes of a position. */
export const POSITION_STEPS = 65535;

/** Alpha of a rotation whose w is left out; those without x, y and z follow. */
export const FIRST_MODE = 252;
