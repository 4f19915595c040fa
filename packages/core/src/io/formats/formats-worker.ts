import { browserDecoder } from '../containers/browser-webp.ts';
import { type LoadPort, serveLoad } from '../loading/serve-load.ts';
import { ALL_READERS } from './readers.ts';

// Of a SOG: the answer is there before the images are.
void browserDecoder();
serveLoad(self as unknown as LoadPort, ALL_READERS);
