/** Bytes before the splats, in every version; those of version 4 go on. */
export const HEADER_BYTES = 16;
export const FLAG_ANTIALIASED = 1;

/** Factor of the first coefficients in the file, which are bytes about the middle. */
export const COLOR_SCALE = 0.15;
