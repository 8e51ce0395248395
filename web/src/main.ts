/** The page: wires the parts together. Everything with an idea of its own is a module. */

import './slider.css';
import { Application } from './application';
import { byId } from './dom';

const application = new Application(byId<HTMLCanvasElement>('view'));
application.start();
