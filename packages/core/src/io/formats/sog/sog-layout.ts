// Shared by the reader and the writer of SOG.

/** Palette entries per row of the palette's image. */
export const PALETTE_COLUMNS = 64;

/** Largest value of a 16-bit position. */
export const POSITION_STEPS = 65535;

/** Alpha of a rotation without w; the next three values stand for x, y and z. */
export const FIRST_MODE = 252;
