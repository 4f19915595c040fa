import { latin1 } from '../latin1.ts';
import type { SplatFormat } from '../splat-format.ts';

/** Metadata of SOG (`meta.json`) or of streamed SOG (`lod-meta.json`); images lie beside it. */
export const sogFormat: SplatFormat = {
  name: 'sog',
  title: 'SOG',
  extensions: ['.json'],
  leadingFile: /^(?:lod-)?meta\.json$/,
  recognise: (firstBytes, fileName) => {
    const text = latin1(firstBytes);
    if (!/^(?:\xef\xbb\xbf)?\s*\{/.test(text)) return false;
    return /"(?:means|lodLevels)"\s*:/.test(text) || /^(?:lod-)?meta\.json$/i.test(fileName);
  },
};
