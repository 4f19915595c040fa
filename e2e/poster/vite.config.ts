import { fileURLToPath } from 'node:url';
import config from '../react/vite.config.ts';

// Built as that page is.
export default { ...config, root: fileURLToPath(new URL('.', import.meta.url)) };
