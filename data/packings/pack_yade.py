# SPDX-License-Identifier: GPL-3.0-or-later
# 25 discs settled in a box of walls, as YADE exports them
import random
from yade import export
random.seed(3)
O.materials.append(FrictMat(young=1e7, poisson=0.3, density=2500, frictionAngle=0.4))
for row in range(5):
    for column in range(5):
        b = sphere((0.006 + 0.0105 * column + 0.0005 * random.random(), 0.006 + 0.0105 * row, 0),
                   random.choice([0.0045, 0.005]))
        b.state.blockedDOFs = 'zXY'
        O.bodies.append(b)
O.bodies.append([wall(0, axis=0), wall(0.055, axis=0), wall(0, axis=1)])
O.engines = [ForceResetter(),
             InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()]),
             InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],
                             [Ip2_FrictMat_FrictMat_FrictPhys()], [Law2_ScGeom_FrictPhys_CundallStrack()]),
             NewtonIntegrator(gravity=(0, -9.81, 0), damping=0.4)]
O.dt = 0.4 * PWaveTimeStep()
O.run(20000, True)
export.text('settled.txt')
export.textExt('settled_ids.txt', 'id_x_y_z_r_matId')
with open('settled_contacts.txt', 'w') as file:
    file.write('# id1 id2\n')
    for i in O.interactions:
        if i.isReal and i.id1 < 25 and i.id2 < 25:
            file.write('%d %d\n' % (i.id1, i.id2))
print('unbalanced', unbalancedForce())
