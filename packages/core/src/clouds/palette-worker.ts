import { type PalettePort, servePalette } from './serve-palette.ts';

servePalette(self as unknown as PalettePort);
