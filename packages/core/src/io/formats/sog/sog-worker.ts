import { browserDecoder } from '../../containers/browser-webp.ts';
import { type LoadPort, serveLoad } from '../../loading/serve-load.ts';
import { openFiles } from '../../sources/open-files.ts';
import { onlyOf } from '../splat-format.ts';
import { readSog } from './sog.ts';
import { sogFormat } from './sog-format.ts';

// The answer is there before the images are.
void browserDecoder();
serveLoad(self as unknown as LoadPort, { ...onlyOf(sogFormat, readSog), openFiles });
