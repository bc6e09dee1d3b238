"""Regions of hardening and softening of k(speed).

design    axes, start and definitions
point     one point: stiffness, contact, edges of the grooves
curves    change, exponent and saturation of k over speed
workers   curves in processes
study     the whole map;  command: ``raceway study map``
page      map.json, map.csv and map.html;  picture: its pictures
"""
